//! The program as a user meets it: its command line, the files it reads and writes, and what it says of mistakes.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on stops loudly")]

#[path = "../common/mod.rs"]
mod common;
mod sandbox;

mod animating;
mod circles;
mod command_line;
mod converting;
mod cropping;
mod darkness;
mod diff;
mod display;
mod errors;
mod explain;
mod figure;
mod flights;
mod gather;
mod grouping;
mod guide;
mod html;
mod inputs;
mod keeping;
mod layering;
mod manual;
mod meters;
mod outliers;
mod outputs;
mod page;
mod phase;
mod pixel;
mod progressive;
mod reading;
mod saying;
mod smoke;
mod starting;
mod strategies;
mod study;
mod unseen;
mod viewing;
