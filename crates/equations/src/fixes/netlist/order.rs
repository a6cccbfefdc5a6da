//! The order in which the voltages of a rewired circuit are computed.

use super::{Netlist, Rewiring};

/// An order in which each element comes after those on whose outputs it depends in the same instant.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::fixes) struct Order {
    /// All elements.
    pub elements: Vec<usize>,
    /// The elements at which loops without an integrator are opened. Their outputs are unknown at first.
    pub tears: Vec<usize>,
}

/// The state of an element during the search for the order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    /// Not reached yet.
    New,
    /// On the path.
    Open,
    /// In the order.
    Done,
}

impl Order {
    /// The order for a rewiring. Loops are opened at open amplifiers where possible.
    pub(in crate::fixes) fn new(netlist: &Netlist, rewiring: &Rewiring) -> Order {
        let count = netlist.len();
        let mut marks = vec![Mark::New; count];
        let mut order = Order { elements: Vec::with_capacity(count), tears: Vec::new() };
        let amplifiers = (0..count).filter(|element| netlist.is_open_amplifier(*element));
        for root in amplifiers.chain(0..count) {
            order.visit(root, netlist, rewiring, &mut marks);
        }
        order
    }

    /// Adds an element after all elements on which it depends.
    fn visit(&mut self, root: usize, netlist: &Netlist, rewiring: &Rewiring, marks: &mut [Mark]) {
        if marks[root] != Mark::New {
            return;
        }
        marks[root] = Mark::Open;
        // The elements of the path, each with the number of its cords that were followed.
        let mut path = vec![(root, 0)];
        while let Some((element, followed)) = path.last_mut() {
            let element = *element;
            let Some(link) = netlist.links(element, rewiring).get(*followed) else {
                marks[element] = Mark::Done;
                self.elements.push(element);
                path.pop();
                continue;
            };
            *followed += 1;
            if !netlist.is_direct(element, link.input) {
                continue;
            }
            match marks[link.from] {
                Mark::New => {
                    marks[link.from] = Mark::Open;
                    path.push((link.from, 0));
                }
                Mark::Open if !self.tears.contains(&link.from) => self.tears.push(link.from),
                Mark::Open | Mark::Done => {}
            }
        }
    }

    /// The number of loops without an integrator that no open amplifier opens.
    pub(in crate::fixes) fn closed_loops(&self, netlist: &Netlist) -> usize {
        self.tears.iter().filter(|tear| !netlist.is_open_amplifier(**tear)).count()
    }
}
