//! Functions that a user wrote in Python, recorded there by `_trace.py` as a list of operations.

use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use stick_slip::{Error, ForceElement, ForceField, ForceLaw, FrictionLaw, Scalar, TimeFunction};

/// One operation on the number under way, the accumulator. A binary operation reads a slot too.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(u8)]
enum Code {
    Load,
    Store,
    Constant,
    AddConstant,
    SubtractConstant,
    MultiplyConstant,
    DivideConstant,
    Add,
    Subtract,
    SubtractFrom,
    Multiply,
    MultiplyOnto,
    Divide,
    DivideInto,
    Negate,
    Recip,
    Square,
    Exp,
    Ln,
    Sqrt,
    Powi,
    Powf,
    Tanh,
    Atan,
    Sin,
    Cos,
    Abs,
}

/// The names of the operations, as `_trace.py` writes them.
const NAMES: [(&str, Code); 27] = [
    ("load", Code::Load),
    ("store", Code::Store),
    ("constant", Code::Constant),
    ("add_constant", Code::AddConstant),
    ("subtract_constant", Code::SubtractConstant),
    ("multiply_constant", Code::MultiplyConstant),
    ("divide_constant", Code::DivideConstant),
    ("add", Code::Add),
    ("subtract", Code::Subtract),
    ("subtract_from", Code::SubtractFrom),
    ("multiply", Code::Multiply),
    ("multiply_onto", Code::MultiplyOnto),
    ("divide", Code::Divide),
    ("divide_into", Code::DivideInto),
    ("negate", Code::Negate),
    ("recip", Code::Recip),
    ("square", Code::Square),
    ("exp", Code::Exp),
    ("ln", Code::Ln),
    ("sqrt", Code::Sqrt),
    ("powi", Code::Powi),
    ("powf", Code::Powf),
    ("tanh", Code::Tanh),
    ("atan", Code::Atan),
    ("sin", Code::Sin),
    ("cos", Code::Cos),
    ("abs", Code::Abs),
];

/// Numbers beside the accumulator, a power of two. The first ones hold the arguments.
const SLOTS: usize = 4;

/// The same for fields, which have more arguments.
const FIELD_SLOTS: usize = 16;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Operation {
    code: Code,
    slot: u8,
    constant: f64,
}

/// The operations of one analytic function of one or two numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Programme(Vec<Operation>);

/// An operation as Python writes it: name, slot, constant.
pub type Written = (String, usize, f64);

impl Programme {
    fn read(written: &[Written], slots: usize) -> PyResult<Self> {
        let operation = |(name, slot, constant): &Written| {
            let code = NAMES.iter().find(|(known, _)| known == name);
            match code {
                Some(&(_, code)) if *slot < slots => Ok(Operation {
                    code,
                    slot: *slot as u8,
                    constant: *constant,
                }),
                _ => Err(PyValueError::new_err(format!(
                    "no operation {name} on slot {slot}"
                ))),
            }
        };
        written
            .iter()
            .map(operation)
            .collect::<PyResult<_>>()
            .map(Self)
    }

    /// The function of a multiple of the first argument.
    fn of_multiple(&self, factor: f64) -> Self {
        let operation = |code, constant| Operation {
            code,
            slot: 0,
            constant,
        };
        let first = [
            operation(Code::MultiplyConstant, factor),
            operation(Code::Store, 0.0),
        ];
        Self(first.into_iter().chain(self.0.iter().copied()).collect())
    }

    /// The value of a law of one or two arguments.
    #[inline(always)]
    fn run<S: Scalar, const N: usize>(&self, arguments: [S; N]) -> S {
        self.run_on::<S, N, SLOTS>(arguments)
    }

    /// One loop over a flat list without a recursion, so that it is inlined to where series are
    /// computed with fused multiply-adds. The operations of a law have an order: a product of two
    /// series and the product the other way round differ in the last bits.
    #[inline(always)]
    fn run_on<S: Scalar, const N: usize, const SLOTS: usize>(&self, arguments: [S; N]) -> S {
        let mut number = arguments[0];
        let mut slots = [number; SLOTS];
        slots[..N].copy_from_slice(&arguments);
        for &Operation {
            code,
            slot,
            constant,
        } in &self.0
        {
            let slot = &mut slots[usize::from(slot) & (SLOTS - 1)];
            number = match code {
                Code::Load => *slot,
                Code::Store => {
                    *slot = number;
                    number
                }
                Code::Constant => number.constant(constant),
                Code::AddConstant => number + constant,
                Code::SubtractConstant => number - constant,
                Code::MultiplyConstant => number * constant,
                Code::DivideConstant => number / constant,
                Code::Add => number + *slot,
                Code::Subtract => number - *slot,
                Code::SubtractFrom => *slot - number,
                Code::Multiply => number * *slot,
                Code::MultiplyOnto => *slot * number,
                Code::Divide => number / *slot,
                Code::DivideInto => *slot / number,
                Code::Negate => -number,
                Code::Recip => number.recip(),
                Code::Square => number.square(),
                Code::Exp => number.exp(),
                Code::Ln => number.ln(),
                Code::Sqrt => number.sqrt(),
                Code::Powi => number.powi(constant as i32),
                Code::Powf => number.powf(constant),
                Code::Tanh => number.tanh(),
                Code::Atan => number.atan(),
                Code::Sin => number.sin(),
                Code::Cos => number.cos(),
                Code::Abs => number.abs(),
            };
        }
        number
    }
}

/// A friction law of a user: one programme for each piece.
#[derive(Clone, Debug)]
pub struct Traced {
    static_coefficient: f64,
    pieces: Arc<[Programme]>,
    breakpoints: Arc<[f64]>,
}

impl Traced {
    /// There must be one piece more than breakpoints.
    pub fn new(static_coefficient: f64, pieces: Vec<Programme>, breakpoints: Vec<f64>) -> Self {
        Self {
            static_coefficient,
            pieces: pieces.into(),
            breakpoints: breakpoints.into(),
        }
    }

    /// The law over speeds in another unit: the operations of the crate's `Scaled`.
    pub fn scaled(&self, unit: f64) -> Self {
        let pieces = self.pieces.iter().map(|piece| piece.of_multiple(unit));
        Self {
            static_coefficient: self.static_coefficient,
            pieces: pieces.collect(),
            breakpoints: self.breakpoints.iter().map(|speed| speed / unit).collect(),
        }
    }

    /// Checks what every system checks of its law.
    pub fn check(&self) -> Result<(), Error> {
        stick_slip::MassOnBelt::new(self, 1.0).map(|_| ())
    }
}

impl FrictionLaw for Traced {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }

    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        if self.breakpoints.is_empty() {
            return self.kinetic_on(0, speed);
        }
        let at = speed.value();
        self.kinetic_on(
            self.breakpoints.partition_point(|point| *point <= at),
            speed,
        )
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.breakpoints.iter().copied()
    }

    #[inline(always)]
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        self.pieces[piece.min(self.pieces.len() - 1)].run([speed])
    }
}

/// The pieces of a function as Python wrote it, and their formulas, which stand for the function.
pub fn pieces_of<'py>(
    py: Python<'py>,
    function: &Bound<'py, PyAny>,
    breakpoints: usize,
    names: &[&str],
) -> PyResult<(Vec<Programme>, Bound<'py, PyAny>)> {
    let trace = py.import("stick_slip._trace")?;
    let arguments = (function, breakpoints + 1, names);
    let (written, formulas): (Vec<Vec<Written>>, Bound<'py, PyAny>) =
        trace.call_method1("trace_pieces", arguments)?.extract()?;
    Ok((programmes(&written, SLOTS)?, formulas))
}

fn programmes(written: &[Vec<Written>], slots: usize) -> PyResult<Vec<Programme>> {
    let programmes = written.iter().map(|one| Programme::read(one, slots));
    programmes.collect()
}

/// A law of force of a user: one programme of position and velocity for each piece, and one of the
/// position for each piece of its potential.
#[derive(Clone, Debug)]
pub struct TracedForce {
    pub pieces: Arc<[Programme]>,
    pub potential: Option<Arc<[Programme]>>,
    pub breakpoints: Arc<[f64]>,
}

impl ForceLaw for TracedForce {
    #[inline(always)]
    fn force<S: Scalar>(&self, position: S, velocity: S, piece: usize) -> S {
        self.pieces[piece.min(self.pieces.len() - 1)].run([position, velocity])
    }

    fn potential<S: Scalar>(&self, position: S, piece: usize) -> Option<S> {
        let potential = self.potential.as_ref()?;
        Some(potential[piece.min(potential.len() - 1)].run([position]))
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.breakpoints.iter().copied()
    }
}

/// Forces of a user along M directions: a programme of all positions and velocities for each, and
/// one of the positions for their potential.
#[derive(Clone, Debug)]
pub struct TracedField<const M: usize> {
    forces: Arc<[Programme]>,
    potential: Option<Arc<Programme>>,
}

impl<const M: usize> ForceField for TracedField<M> {
    type Coordinates<S: Scalar> = [S; M];

    #[inline(always)]
    fn forces<S: Scalar>(&self, positions: [S; M], velocities: [S; M]) -> [S; M] {
        // The slots that are left are there for intermediate results.
        let mut arguments = [positions[0]; FIELD_SLOTS];
        arguments[..M].copy_from_slice(&positions);
        arguments[M..2 * M].copy_from_slice(&velocities);
        std::array::from_fn(|i| self.forces[i].run_on::<S, FIELD_SLOTS, FIELD_SLOTS>(arguments))
    }

    fn potential<S: Scalar>(&self, positions: [S; M]) -> Option<S> {
        let potential = self.potential.as_ref()?;
        Some(potential.run_on::<S, M, FIELD_SLOTS>(positions))
    }
}

/// Recorded forces along several directions, with the formulas that stand for the functions.
pub struct Field<'py> {
    forces: Arc<[Programme]>,
    potential: Option<Arc<Programme>>,
    pub formulas: Bound<'py, PyAny>,
    pub energy: Option<Bound<'py, PyAny>>,
}

impl<'py> Field<'py> {
    pub fn of(
        count: usize,
        forces: &Bound<'py, PyAny>,
        potential: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        if !(2..=4).contains(&count) {
            return Err(PyValueError::new_err(format!(
                "a field has 2, 3 or 4 directions, not {count}; a force of one direction is \
                 ForceElement(direction, ForceLaw(function))"
            )));
        }
        let trace = forces.py().import("stick_slip._trace")?;
        let recorded = |function: &str, of: &Bound<'py, PyAny>| {
            let found = trace.call_method1(function, (of, count, FIELD_SLOTS))?;
            let (written, formulas): (Vec<Vec<Written>>, Bound<'py, PyAny>) = found.extract()?;
            Ok::<_, PyErr>((programmes(&written, FIELD_SLOTS)?, formulas))
        };
        let (forces, formulas) = recorded("trace_field", forces)?;
        let potential = potential.map(|energy| recorded("trace_potential", energy));
        let (potential, energy) = potential.transpose()?.unzip();
        Ok(Self {
            forces: forces.into(),
            potential: potential.map(|mut one| Arc::new(one.swap_remove(0))),
            formulas,
            energy,
        })
    }

    pub fn element(&self, directions: &[&[(usize, f64)]]) -> Result<ForceElement, Error> {
        match directions.len() {
            2 => ForceElement::field(directions, self.traced::<2>()),
            3 => ForceElement::field(directions, self.traced::<3>()),
            _ => ForceElement::field(directions, self.traced::<4>()),
        }
    }

    fn traced<const M: usize>(&self) -> TracedField<M> {
        TracedField {
            forces: self.forces.clone(),
            potential: self.potential.clone(),
        }
    }
}

/// A function of time of a user: one programme for each piece.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedTime {
    pub pieces: Arc<[Programme]>,
    pub breakpoints: Arc<[f64]>,
    pub size: f64,
    pub timescale: f64,
    pub period: Option<f64>,
}

impl TimeFunction for TracedTime {
    #[inline(always)]
    fn value<S: Scalar>(&self, time: S, piece: usize) -> S {
        self.pieces[piece.min(self.pieces.len() - 1)].run([time])
    }

    fn size(&self) -> f64 {
        self.size
    }

    fn timescale(&self, _: usize) -> f64 {
        self.timescale
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.breakpoints.iter().copied()
    }

    fn period(&self) -> Option<f64> {
        self.period
    }
}
