//! A structure as its engine sees it: divided by the masses, without zeros.

use super::sparse::Sparse;
use super::system::Structure;
use crate::drive::Drive;

/// What moves, what acts on it, and how fast it could go.
#[derive(Debug, Clone)]
pub(super) struct Model<'s> {
    /// K_ij/m_i.
    pub(super) stiffness: Sparse,
    /// C_ij/m_i.
    pub(super) damping: Sparse,
    /// 1/m_i.
    pub(super) inverse_mass: Vec<f64>,
    /// The drives that are not constant.
    pub(super) varying: Vec<(Target, &'s Drive)>,
    /// Largest |i − j| of coordinates of which one acts on the other.
    pub(super) bandwidth: usize,
    /// 1/√(max_i Σ_j |K_ij|/m_i): no free vibration without friction is faster than one radian in
    /// this time. Where nothing is elastic that of the dampers, and infinite without any.
    pub(super) time_unit: f64,
}

/// What a drive acts on.
#[derive(Debug, Clone, Copy)]
pub(super) enum Target {
    /// The force on a coordinate.
    Force(usize),
    /// The velocity of the surface under a contact.
    Surface(usize),
    /// The load of a contact.
    Load(usize),
}

impl<'s> Model<'s> {
    pub(super) fn new<L, const Z: usize>(structure: &'s Structure<L, Z>) -> Self {
        let inverse_mass: Vec<f64> = structure.masses().iter().map(|m| m.recip()).collect();
        let by_mass = |i: usize, _: usize| inverse_mass[i];
        let stiffness = Sparse::scaled(structure.stiffness(), by_mass);
        let damping = Sparse::scaled(structure.damping(), by_mass);
        let forces = structure.forces().iter().enumerate();
        let forces = forces.map(|(i, drive)| (Target::Force(i), drive));
        let contacts = structure.contacts().iter().enumerate();
        let contacts = contacts.flat_map(|(c, contact)| {
            let surface = (Target::Surface(c), contact.belt_velocity());
            [surface, (Target::Load(c), contact.load())]
        });
        let varying = forces.chain(contacts);
        let varying = varying.filter(|(_, drive)| !drive.is_constant()).collect();
        let elastic = largest_row(&stiffness);
        let rate = if elastic > 0.0 {
            elastic.sqrt()
        } else {
            largest_row(&damping)
        };
        let loads = structure.contacts().iter().flat_map(|contact| {
            let gradient = contact.load_gradient().iter();
            gradient.map(|&(j, _)| contact.coordinate().abs_diff(j))
        });
        let bandwidth = [stiffness.bandwidth(), damping.bandwidth()];
        Self {
            bandwidth: loads.chain(bandwidth).max().unwrap_or(0),
            stiffness,
            damping,
            inverse_mass,
            varying,
            time_unit: rate.recip(),
        }
    }
}

/// Largest Σ_j |a_ij|.
fn largest_row(matrix: &Sparse) -> f64 {
    let rows = matrix.rows().map(|(diagonal, beside)| {
        diagonal.abs() + beside.iter().map(|(_, a)| a.abs()).sum::<f64>()
    });
    rows.fold(0.0, f64::max)
}
