//! Makes the plan of a problem: the graph of the operations that compute its quantities.
//!
//! `unknowns` and `matching` find the equation that determines each quantity. `solution` solves it, `rational` if there
//! are quotients or squares of the quantity, and `joint` if several equations share their unknowns. `expressions`,
//! `functions`, `powers`, `products` and `angles` read the equations as nodes, which `builder` collects. `signs` makes two
//! comparators of a sign whose argument can stay at 0. `finish` joins equal nodes and determines the signs of implicit
//! equations, with the values at the start from `peaks` and from `start_expressions`. `peaks` then finds the range of every
//! node, and `synthesis` turns a plan with scales into a patch.

mod angles;
mod builder;
mod constants;
mod expressions;
mod extent;
mod finish;
mod functions;
mod initial;
mod joint;
mod matching;
mod names;
mod planner;
mod powers;
mod products;
mod rational;
mod signs;
mod simplify;
mod solution;
mod start_expressions;
mod trees;
mod undetermined;
mod unknowns;

pub(crate) use planner::plan;

#[cfg(test)]
mod tests;
