//! Circuits with which the thesis compares its own circuit: Singh's, Nakashima's, and Fig 8.16 with the lag behind
//! the multiplier. The numbers of docs/others.md are measured here.

mod lag_last;
mod nakashima;
mod nakashima_points;
mod page;
mod relays;
mod singh;
mod steady_run;
