//! How many threads sweeps are measured with.

/// 1, 2, 4, ... as far as there are cores, and all the cores.
pub fn up_to(cores: usize) -> Vec<usize> {
    let doubled = std::iter::successors(Some(1), |threads| Some(2 * threads));
    doubled.take_while(|threads| *threads < cores).chain([cores]).collect()
}
