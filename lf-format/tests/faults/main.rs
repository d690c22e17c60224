//! Saving a file leaves the old one or the new one, whole, whatever fails on the way and whenever the process dies.
//!
//! What fails is the operating system: a full disk, system calls that return errors (`strace` injects them, into each call that
//! a save makes), a limit on the size of files, signals that kill. The process that it fails is this program, started again
//! for one job: see [`child`]. What is left is compared, byte for byte, with what may be there.
//!
//! A test that lacks a tool or a right prints `NOT TESTED` and passes; with `LFSLAB_REQUIRE_FAULTS=1` it fails. What a
//! loss of power leaves cannot be seen from here: one test holds the order of flushes and renames on which that depends.

#![cfg(all(unix, feature = "std"))]

mod child;
mod folder;
mod full;
mod injected;
mod killed;
mod paths;
mod races;
mod sample;
mod tools;
