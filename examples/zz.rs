use stick_slip::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let n: usize = a[1].parse().unwrap();
    let law = a[2].as_str();
    let mut s = Structure::new(&vec![1.0; n]).unwrap();
    for i in 0..n {
        s = s.with_ground_spring(i, 1.0 + 0.1 * i as f64).unwrap();
        if i > 0 { s = s.with_spring(i - 1, i, 0.5).unwrap(); }
        s = if law == "exp" {
            s.with_contact(Contact::new(i, Exponential::new(0.4, 0.25, 0.5).unwrap(), 1.0).unwrap().on_belt(0.3)).unwrap()
        } else {
            s.with_contact(Contact::new(i, Stribeck::new(0.4, 0.25, 0.5, 1).unwrap(), 1.0).unwrap().on_belt(0.3)).unwrap()
        };
    }
    let m = s.simulate(structure::State::at_rest(n), 200.0).unwrap();
    println!("{} {:?}", m.steps().len(), m.last().displacements[0]);
}
