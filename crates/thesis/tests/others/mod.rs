//! Circuits of others that the thesis compares its own with: Singh's, Nakashima's, and its own with the lag last. What
//! docs/others.md tells of them is measured here.

mod bench;
mod lag_last;
mod nakashima;
mod page;
mod points;
mod relays;
mod singh;
