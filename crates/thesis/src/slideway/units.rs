//! Units of the thesis in SI. Its empirical formulas use kgf, mm, P and cm/s and are kept as printed.

/// Standard gravity in m/s2. With it the weight of one kilogram is one kgf.
pub const GRAVITY: f64 = 9.80665;
/// One kilogram-force, in N.
pub const KGF: f64 = GRAVITY;
/// One millimetre, in m.
pub const MM: f64 = 1e-3;
/// One micrometre, in m.
pub const UM: f64 = 1e-6;
/// One centimetre, in m.
pub const CM: f64 = 1e-2;
/// One square millimetre, in m2.
pub const MM2: f64 = MM * MM;
/// One square micrometre, in m2.
pub const UM2: f64 = UM * UM;
/// One square centimetre, in m2.
pub const CM2: f64 = CM * CM;
/// One kgf/mm2, in Pa: the unit of hardness, strength and moduli.
pub const KGF_PER_MM2: f64 = KGF / MM2;
/// One kgf/cm2, in Pa: the unit of pressure under a table.
pub const KGF_PER_CM2: f64 = KGF / CM2;
/// One poise, in Pa s.
pub const POISE: f64 = 0.1;
/// One mm/s, in m/s.
pub const MM_PER_S: f64 = MM;
/// One cm/s, in m/s.
pub const CM_PER_S: f64 = CM;
/// One N/mm, in N/m: the unit of drive stiffness.
pub const N_PER_MM: f64 = 1.0 / MM;
/// One N s/mm, in N s/m: the unit of viscous damping and of slopes of friction.
pub const N_S_PER_MM: f64 = 1.0 / MM;
/// One millisecond, in s.
pub const MS: f64 = 1e-3;
