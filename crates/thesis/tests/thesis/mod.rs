//! Tests of the thesis's circuits: comparison with independently written equations and with the statements of the text.

mod circuit_readings;
mod compromise;
mod equations;
mod fig_4_07;
mod fig_8_04;
mod fig_8_05;
mod fig_8_07;
mod fig_8_09;
mod fig_8_11;
mod fig_8_14;
mod fig_8_15;
mod fig_8_16;
mod fig_8_16_both;
mod fig_8_16_coulomb;
mod fig_8_16_lag_last;
mod fig_8_17;
mod instruments;
