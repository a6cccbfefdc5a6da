//! The thesis's circuits against physics written down independently, and against what its text says of them.

mod bench;
mod dice;
mod fig_8_04;
mod fig_8_07;
mod fig_8_11;
mod fig_8_14;
mod fig_8_15;
mod fig_8_16;
mod slideway;
