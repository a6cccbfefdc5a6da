//! Finds the pots whose setting may be a rate.

use petgraph::Direction;
use petgraph::graph::NodeIndex;

use super::Cords;
use crate::circuit::macros;
use crate::circuit::resolve::{Graph, read_by_name};
use crate::elements::Transfer;
use crate::patch::Patch;

/// For every element, whether it is a pot that drives an integrator, directly or through other pots.
///
/// The setting of such a pot may be a rate in 1/s. A pot whose output nothing uses counts as well, because its cord may be
/// missing. If cords have faults, every pot without a cord counts.
pub(super) fn before_integrators(patch: &Patch, graph: &Graph, cords: Cords) -> Vec<bool> {
    let has_transfer = |index: NodeIndex, transfer| graph[index].kind.transfer == transfer;
    let (named, outputs) = (read_by_name(patch), macros::outputs(patch));
    let is_read = |name: &str| named.contains(name) || outputs.contains(name);
    let may_lack_cord = |index: &NodeIndex| {
        has_transfer(*index, Transfer::Share)
            && graph.neighbors(*index).next().is_none()
            && (cords == Cords::Incomplete || !is_read(&graph[*index].name))
    };
    let mut drives_integrator = vec![false; graph.node_count()];
    let mut unvisited: Vec<_> = graph.node_indices().filter(may_lack_cord).collect();
    unvisited.iter().for_each(|index| drives_integrator[index.index()] = true);
    unvisited.extend(graph.node_indices().filter(|index| has_transfer(*index, Transfer::Integrating)));
    while let Some(index) = unvisited.pop() {
        let drivers = graph.neighbors_directed(index, Direction::Incoming);
        for driver in drivers.filter(|driver| has_transfer(*driver, Transfer::Share)) {
            if !std::mem::replace(&mut drives_integrator[driver.index()], true) {
                unvisited.push(driver);
            }
        }
    }
    drives_integrator
}
