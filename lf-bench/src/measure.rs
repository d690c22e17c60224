//! Timing in interleaved rounds by thread CPU time.
//!
//! In each round every contestant works once through all its inputs, one contestant after the other. A machine that
//! changes its speed, or other programs that fill its caches, then disturb all contestants alike, and the median over
//! the rounds drops the rounds that were disturbed. CPU time of the thread instead of wall-clock time keeps out the
//! time in which the thread did not run at all.

use cpu_time::ThreadTime;
use lf_report::Timing;

use crate::codec::Job;
use crate::error::BenchError;

/// A contestant works at least so long in one round, repeating its work if need be: shorter, the first passes through
/// cold caches would dominate.
const ROUND_S: f64 = 0.005;
/// Rounds at least, however slow the contestant.
const FEWEST_ROUNDS: usize = 3;
/// Rounds at most, however fast.
const MOST_ROUNDS: usize = 41;

/// One codec's work on all inputs of a class.
pub struct Contestant<'a> {
    jobs: Vec<Box<dyn Job + 'a>>,
    repeats: usize,
    rounds: Vec<f64>,
}

impl<'a> Contestant<'a> {
    /// Runs each job once, so that its output can be checked and its speed guessed.
    ///
    /// # Errors
    ///
    /// What the first failing job says.
    pub fn warmed_up(mut jobs: Vec<Box<dyn Job + 'a>>) -> Result<Self, String> {
        let seconds = pass(&mut jobs, 1)?;
        // A clock may be too coarse for tiny inputs; a million repetitions are long enough for anything.
        let repeats = (ROUND_S / seconds.max(1e-9)).ceil().clamp(1.0, 1e6) as usize;
        Ok(Self { jobs, repeats, rounds: Vec::new() })
    }

    /// The outputs of the last run, in the order of the inputs.
    #[must_use]
    pub fn outputs(&self) -> Vec<Vec<u8>> {
        self.jobs.iter().map(|job| job.output()).collect()
    }

    fn round(&mut self) -> Result<(), String> {
        self.rounds.push(pass(&mut self.jobs, self.repeats)?);
        Ok(())
    }

    fn is_done(&self, seconds: f64) -> bool {
        let spent: f64 = self.rounds.iter().map(|round| round * self.repeats as f64).sum();
        let rounds = self.rounds.len();
        rounds >= MOST_ROUNDS || rounds >= FEWEST_ROUNDS && spent >= seconds
    }
}

/// Thread CPU seconds of one pass through all jobs, the mean of `repeats`.
fn pass(jobs: &mut [Box<dyn Job + '_>], repeats: usize) -> Result<f64, String> {
    let start = ThreadTime::now();
    for _ in 0..repeats {
        for job in &mut *jobs {
            job.run()?;
        }
    }
    Ok(start.elapsed().as_secs_f64() / repeats as f64)
}

/// Runs rounds until every contestant has spent `seconds` or has had its fill of rounds; `progress` is told the round
/// and how many contestants take part in it.
///
/// # Errors
///
/// What the first failing job says.
pub fn interleaved(
    contestants: &mut [Contestant<'_>],
    seconds: f64,
    mut progress: impl FnMut(usize, usize),
) -> Result<Vec<Timing>, String> {
    for number in 1.. {
        let mut left: Vec<&mut Contestant<'_>> = contestants.iter_mut().filter(|c| !c.is_done(seconds)).collect();
        if left.is_empty() {
            break;
        }
        progress(number, left.len());
        for contestant in &mut left {
            contestant.round()?;
        }
    }
    let timing = |c: &Contestant<'_>| Timing::from_seconds(c.rounds.clone());
    contestants.iter().map(|c| timing(c).ok_or_else(|| "the clock ran backwards".to_owned())).collect()
}

/// Does the work on the only thread of a rayon pool, where parallel code runs on that thread alone.
///
/// # Errors
///
/// [`BenchError::Thread`] if the thread cannot be started.
pub fn one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, BenchError> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(work))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::job_into;

    fn contestant<'a>(work: impl FnMut(&mut [u8]) -> Result<(), String> + 'a) -> Contestant<'a> {
        Contestant::warmed_up(vec![job_into(1, work)]).unwrap()
    }

    #[test]
    fn rounds_are_interleaved_and_bounded() {
        let order = std::cell::RefCell::new(String::new());
        let work = |letter| {
            let order = &order;
            move |_: &mut [u8]| {
                order.borrow_mut().push(letter);
                Ok(())
            }
        };
        let mut both = [contestant(work('a')), contestant(work('b'))];
        for one in &mut both {
            one.repeats = 1;
        }
        order.borrow_mut().clear();
        let timings = interleaved(&mut both, 0.0, |_, _| ()).unwrap();
        assert_eq!(*order.borrow(), "ababab");
        assert!(timings.iter().all(|t| t.samples().len() == FEWEST_ROUNDS));
    }

    #[test]
    fn fast_work_is_repeated_and_failures_are_told() {
        assert!(contestant(|_| Ok(())).repeats > 100);
        let failing = Contestant::warmed_up(vec![job_into(1, |_| Err("no".to_owned()))]);
        assert_eq!(failing.err().as_deref(), Some("no"));
    }

    #[test]
    fn one_thread_is_one() {
        assert_eq!(one_thread(rayon::current_num_threads).unwrap(), 1);
    }
}
