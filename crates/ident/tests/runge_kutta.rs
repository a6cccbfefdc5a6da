//! A Runge-Kutta integrator that shares no code with the program. Tests compare effects with its solutions.

/// Steps of the integrator between two samples.
const STEPS_PER_SAMPLE: usize = 100;

/// The states of x' = `rates`(t, x) at `count` samples, one every `every` seconds, the first at t = 0.
///
/// The method is the classical Runge-Kutta method of fourth order.
pub(crate) fn integrate<const N: usize>(
    initial: [f64; N],
    (every, count): (f64, usize),
    rates: impl Fn(f64, [f64; N]) -> [f64; N],
) -> Vec<[f64; N]> {
    let h = 0.01 * every;
    let advanced = |state: [f64; N], rate: [f64; N], share: f64| {
        std::array::from_fn(|index| state[index] + share * h * rate[index])
    };
    let step = |t: f64, state: [f64; N]| {
        let a = rates(t, state);
        let b = rates(t + 0.5 * h, advanced(state, a, 0.5));
        let c = rates(t + 0.5 * h, advanced(state, b, 0.5));
        let d = rates(t + h, advanced(state, c, 1.0));
        let mean = std::array::from_fn(|index| (a[index] + 2.0 * b[index] + 2.0 * c[index] + d[index]) / 6.0);
        advanced(state, mean, 1.0)
    };
    let next_sample = |state: [f64; N], sample: usize| {
        (0..STEPS_PER_SAMPLE)
            .fold(state, |state, index| step((sample * STEPS_PER_SAMPLE + index) as f64 * h, state))
    };
    (0..count)
        .scan(initial, |state, sample| Some(std::mem::replace(state, next_sample(*state, sample))))
        .collect()
}
