//! Laws of motion worked out without the program.

/// A state at so many samples, by the method of Runge and Kutta in a hundred steps for each.
pub fn integrated<const N: usize>(
    first: [f64; N],
    (every, count): (f64, usize),
    rates: impl Fn(f64, [f64; N]) -> [f64; N],
) -> Vec<[f64; N]> {
    let h = 0.01 * every;
    let moved =
        |from: [f64; N], by: [f64; N], share: f64| std::array::from_fn(|own| from[own] + share * h * by[own]);
    let step = |t: f64, state: [f64; N]| {
        let a = rates(t, state);
        let b = rates(t + 0.5 * h, moved(state, a, 0.5));
        let c = rates(t + 0.5 * h, moved(state, b, 0.5));
        let d = rates(t + h, moved(state, c, 1.0));
        moved(state, std::array::from_fn(|own| (a[own] + 2.0 * b[own] + 2.0 * c[own] + d[own]) / 6.0), 1.0)
    };
    let next = |from: [f64; N], sample: usize| {
        (0..100).fold(from, |state, part| step((sample * 100 + part) as f64 * h, state))
    };
    (0..count).scan(first, |state, sample| Some(std::mem::replace(state, next(*state, sample)))).collect()
}
