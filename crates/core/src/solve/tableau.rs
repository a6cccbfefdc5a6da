//! Runge-Kutta methods as tables of numbers.

/// An explicit Runge-Kutta method. Its first stage stands at the beginning of a step.
#[derive(Debug)]
pub(super) struct Tableau {
    /// The stages after the first: where in the step each stands, and the earlier rates that lead there.
    pub stages: &'static [Stage],
    /// The last of these stages that stands near the middle of a step.
    pub middle: usize,
    /// The stages that are looked at for what comes and goes within a step.
    pub glances: &'static [usize],
    /// The rates that lead to the end of a step, each times so many parts of it.
    pub end: &'static [Share],
    /// How many parts there are. Sixths of whole numbers keep straight lines exact.
    pub parts: f64,
    /// What the end of a second method of lower order differs by. The rate at the end is that of the stage after
    /// the last. Empty where there is no second method.
    pub difference: &'static [Share],
    /// What the curve within a step has beyond the cubic through states and rates at its ends: this times
    /// the square of the share of the step gone and of that left.
    pub bulge: &'static [Share],
    /// The lower order of the two: the difference for each second grows with the length of a step by this power.
    pub order: f64,
}

/// A stage: its place in the step, and how the rates of earlier ones lead to it.
#[derive(Debug)]
pub(super) struct Stage {
    pub at: f64,
    pub from: &'static [Share],
}

/// The rate of a stage, by its index, times a number.
pub(super) type Share = (usize, f64);

/// The classical method of order 4 (Kutta 1901).
pub(super) static CLASSICAL: Tableau = Tableau {
    stages: &[
        Stage { at: 0.5, from: &[(0, 0.5)] },
        Stage { at: 0.5, from: &[(1, 0.5)] },
        Stage { at: 1.0, from: &[(2, 1.0)] },
    ],
    middle: 1,
    glances: &[1],
    end: &[(0, 1.0), (1, 2.0), (2, 2.0), (3, 1.0)],
    parts: 6.0,
    difference: &[],
    bulge: &[],
    order: 4.0,
};

/// The pair of orders 5 and 4 of Dormand and Prince (1980), with the curve of order 4 of Shampine (1986).
pub(super) static DORMAND_PRINCE: Tableau = Tableau {
    stages: &[
        Stage { at: 0.2, from: &[(0, 0.2)] },
        Stage { at: 0.3, from: &[(0, 3.0 / 40.0), (1, 9.0 / 40.0)] },
        Stage { at: 0.8, from: &[(0, 44.0 / 45.0), (1, -56.0 / 15.0), (2, 32.0 / 9.0)] },
        Stage {
            at: 8.0 / 9.0,
            from: &[
                (0, 19372.0 / 6561.0),
                (1, -25360.0 / 2187.0),
                (2, 64448.0 / 6561.0),
                (3, -212.0 / 729.0),
            ],
        },
        Stage {
            at: 1.0,
            from: &[
                (0, 9017.0 / 3168.0),
                (1, -355.0 / 33.0),
                (2, 46732.0 / 5247.0),
                (3, 49.0 / 176.0),
                (4, -5103.0 / 18656.0),
            ],
        },
    ],
    middle: 1,
    glances: &[1, 2],
    end: &[
        (0, 35.0 / 384.0),
        (2, 500.0 / 1113.0),
        (3, 125.0 / 192.0),
        (4, -2187.0 / 6784.0),
        (5, 11.0 / 84.0),
    ],
    parts: 1.0,
    difference: &[
        (0, 71.0 / 57600.0),
        (2, -71.0 / 16695.0),
        (3, 71.0 / 1920.0),
        (4, -17253.0 / 339200.0),
        (5, 22.0 / 525.0),
        (6, -1.0 / 40.0),
    ],
    bulge: &[
        (0, -12715105075.0 / 11282082432.0),
        (2, 87487479700.0 / 32700410799.0),
        (3, -10690763975.0 / 1880347072.0),
        (4, 701980252875.0 / 199316789632.0),
        (5, -1453857185.0 / 822651844.0),
        (6, 69997945.0 / 29380423.0),
    ],
    order: 4.0,
};

impl Tableau {
    /// Rates that a step keeps: those of its stages, and that at its end.
    pub fn rates(&self) -> usize {
        self.stages.len() + 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(shares: &[Share]) -> f64 {
        shares.iter().map(|(_, share)| share).sum()
    }

    #[test]
    fn rates_that_stay_the_same_are_integrated_exactly() {
        for tableau in [&CLASSICAL, &DORMAND_PRINCE] {
            for stage in tableau.stages {
                assert!((total(stage.from) - stage.at).abs() < 1e-14, "{stage:?}");
            }
            assert!((total(tableau.end) - tableau.parts).abs() < 1e-14);
            assert!(total(tableau.difference).abs() < 1e-14 && total(tableau.bulge).abs() < 1e-14);
        }
    }

    #[test]
    fn powers_of_time_are_integrated_up_to_the_order() {
        for (tableau, order) in [(&CLASSICAL, 4), (&DORMAND_PRINCE, 5)] {
            let at = |stage: usize| if stage == 0 { 0.0 } else { tableau.stages[stage - 1].at };
            for power in 0..order {
                let sum: f64 = tableau.end.iter().map(|(stage, share)| share * at(*stage).powi(power)).sum();
                assert!((sum / tableau.parts - 1.0 / f64::from(power + 1)).abs() < 1e-14, "{power}");
            }
        }
    }
}
