//! The thread counts with which sweeps are measured. tests/docs.rs uses this file, too.

/// 1, 2, 4, ... below the number of cores, and the number of cores.
pub(crate) fn up_to(cores: usize) -> Vec<usize> {
    let doubled = std::iter::successors(Some(1), |threads| Some(2 * threads));
    doubled.take_while(|threads| *threads < cores).chain([cores]).collect()
}
