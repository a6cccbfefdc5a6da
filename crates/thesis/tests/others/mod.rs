//! Circuits with which the thesis compares its own circuit: Singh's, Nakashima's, and Fig 8.16 with the lag behind
//! the multiplier. The numbers of docs/others.md are measured here.

mod bench;
mod lag_last;
mod nakashima;
mod page;
mod points;
mod relays;
mod singh;
