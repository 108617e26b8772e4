//! Sorting by a number: the algorithm is compiled once, not for each type of item.

use std::mem::replace;

/// Sorts items by their keys in ascending order. Items with one key keep their order.
pub(crate) fn sort_by<T>(items: &mut [T], key: impl Fn(&T) -> f64) {
    let keys: Vec<f64> = items.iter().map(key).collect();
    let mut order = order(&keys);
    for start in 0..items.len() {
        let mut place = start;
        loop {
            let from = replace(&mut order[place], place);
            if from == start || from == place {
                break;
            }
            items.swap(place, from);
            place = from;
        }
    }
}

/// The numbers of the keys in ascending order of the keys.
pub(crate) fn order(keys: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..keys.len()).collect();
    order.sort_by(|&i, &j| keys[i].total_cmp(&keys[j]));
    order
}

#[cfg(test)]
mod tests {
    use super::sort_by;

    #[test]
    fn every_order_is_sorted_as_by_the_standard_library() {
        let mut state = 1_u64;
        for length in 0..40 {
            for _ in 0..50 {
                let numbered = (0..length).map(|i| {
                    state = state
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(1);
                    (((state >> 60) as f64 - 8.0) * 0.5, i)
                });
                let mut items: Vec<(f64, usize)> = numbered.collect();
                let mut sorted = items.clone();
                sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
                sort_by(&mut items, |item| item.0);
                assert_eq!(items, sorted);
            }
        }
    }
}
