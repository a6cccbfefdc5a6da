//! Runge-Kutta methods as Butcher tableaus.
//!
//! `runge_kutta` takes the steps of every method. The tables here specify the stages, the weights of the end of a step,
//! the error estimate and the dense output. All weights are sparse: a pair (stage, weight) for each weight that is not
//! 0.

/// An explicit Runge-Kutta method. Its first stage is the beginning of a step and is not listed, so stage i of a
/// [`StageWeight`] is `stages[i - 1]`.
#[derive(Debug)]
pub struct Tableau {
    /// The stages after the first.
    pub stages: &'static [Stage],
    /// Index in `stages` of the last stage near the middle of a step. Its voltages choose the side of each kink for the
    /// derivatives.
    pub middle_stage: usize,
    /// Indices in `stages` of the stages that are checked for events that come and go within a step.
    pub checked_stages: [usize; 2],
    /// The weights of the rates at the end of a step, each multiplied by `divisor`.
    pub end_weights: &'static [StageWeight],
    /// The number by which `end_weights` are divided. Sixths as whole numbers keep straight lines exact.
    pub divisor: f64,
    /// The weights of the error estimate: the difference from a second method of lower order. The last stage is the end
    /// of the step. Empty if there is no second method.
    pub error_weights: &'static [StageWeight],
    /// The weights of the correction that dense output adds to the cubic through states and rates at both ends. After a
    /// share s of a step the correction is multiplied by s^2 (1 - s)^2 and the length. Empty if there is none.
    pub dense_correction: &'static [StageWeight],
    /// The lower order of the pair: the error per second grows with the length of a step to this power. The step
    /// control uses it.
    pub error_order: f64,
}

/// A stage of a step.
#[derive(Debug)]
pub struct Stage {
    /// The instant of the stage as a share (0 ... 1) of the step.
    pub node: f64,
    /// The weights of the rates of earlier stages. Their sum is the node.
    pub weights: &'static [StageWeight],
}

/// The index of a stage (0 for the first) and the weight of its rate.
pub type StageWeight = (usize, f64);

/// The classical method of order 4 (Kutta 1901), for equal steps.
pub(super) static CLASSICAL: Tableau = Tableau {
    stages: &[
        Stage { node: 0.5, weights: &[(0, 0.5)] },
        Stage { node: 0.5, weights: &[(1, 0.5)] },
        Stage { node: 1.0, weights: &[(2, 1.0)] },
    ],
    middle_stage: 1,
    checked_stages: [0, 1],
    end_weights: &[(0, 1.0), (1, 2.0), (2, 2.0), (3, 1.0)],
    divisor: 6.0,
    error_weights: &[],
    dense_correction: &[],
    error_order: 4.0,
};

/// The pair of orders 5 and 4 of Dormand and Prince (1980), with the dense output of order 4 of Shampine (1986), for
/// steps that adapt to a tolerance. Node 0.3 is the stage near the middle.
pub static DORMAND_PRINCE: Tableau = Tableau {
    stages: &[
        Stage { node: 0.2, weights: &[(0, 0.2)] },
        Stage { node: 0.3, weights: &[(0, 3.0 / 40.0), (1, 9.0 / 40.0)] },
        Stage { node: 0.8, weights: &[(0, 44.0 / 45.0), (1, -56.0 / 15.0), (2, 32.0 / 9.0)] },
        Stage {
            node: 8.0 / 9.0,
            weights: &[
                (0, 19372.0 / 6561.0),
                (1, -25360.0 / 2187.0),
                (2, 64448.0 / 6561.0),
                (3, -212.0 / 729.0),
            ],
        },
        Stage {
            node: 1.0,
            weights: &[
                (0, 9017.0 / 3168.0),
                (1, -355.0 / 33.0),
                (2, 46732.0 / 5247.0),
                (3, 49.0 / 176.0),
                (4, -5103.0 / 18656.0),
            ],
        },
    ],
    middle_stage: 1,
    checked_stages: [1, 2],
    end_weights: &[
        (0, 35.0 / 384.0),
        (2, 500.0 / 1113.0),
        (3, 125.0 / 192.0),
        (4, -2187.0 / 6784.0),
        (5, 11.0 / 84.0),
    ],
    divisor: 1.0,
    error_weights: &[
        (0, 71.0 / 57600.0),
        (2, -71.0 / 16695.0),
        (3, 71.0 / 1920.0),
        (4, -17253.0 / 339200.0),
        (5, 22.0 / 525.0),
        (6, -1.0 / 40.0),
    ],
    dense_correction: &[
        (0, -12715105075.0 / 11282082432.0),
        (2, 87487479700.0 / 32700410799.0),
        (3, -10690763975.0 / 1880347072.0),
        (4, 701980252875.0 / 199316789632.0),
        (5, -1453857185.0 / 822651844.0),
        (6, 69997945.0 / 29380423.0),
    ],
    error_order: 4.0,
};

impl Tableau {
    /// Number of rates that a step keeps for each state: one for every stage, the first included, and one at its end.
    pub fn rates(&self) -> usize {
        self.stages.len() + 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(weights: &[StageWeight]) -> f64 {
        weights.iter().map(|(_, weight)| weight).sum()
    }

    #[test]
    fn constant_rates_are_integrated_exactly() {
        for tableau in [&CLASSICAL, &DORMAND_PRINCE] {
            for stage in tableau.stages {
                assert!((total(stage.weights) - stage.node).abs() < 1e-14, "{stage:?}");
            }
            assert!((total(tableau.end_weights) - tableau.divisor).abs() < 1e-14);
            assert!(
                total(tableau.error_weights).abs() < 1e-14 && total(tableau.dense_correction).abs() < 1e-14
            );
        }
    }

    #[test]
    fn powers_of_time_are_integrated_up_to_the_order() {
        for (tableau, order) in [(&CLASSICAL, 4), (&DORMAND_PRINCE, 5)] {
            let node = |stage: usize| if stage == 0 { 0.0 } else { tableau.stages[stage - 1].node };
            for power in 0..order {
                let integral: f64 =
                    tableau.end_weights.iter().map(|(stage, weight)| weight * node(*stage).powi(power)).sum();
                assert!((integral / tableau.divisor - 1.0 / f64::from(power + 1)).abs() < 1e-14, "{power}");
            }
        }
    }
}
