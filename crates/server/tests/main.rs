//! Integration tests of the server: who may use it, what it serves, its limits, and the page about its protocol.

mod client;
mod comparisons;
mod limits;
mod pages;
mod protocol;
mod sessions;
