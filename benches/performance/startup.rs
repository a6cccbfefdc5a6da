//! The table of start-up: the whole process of `patchcord run` on Fig 8.16 with one step.

use std::path::Path;
use std::process::Command;

use crate::timing::{format_seconds, timed};
use crate::{Outcome, page};

/// Measured processes.
const STARTS: usize = 40;

/// The table.
pub(crate) fn table() -> Outcome<String> {
    let patch = Path::new(env!("CARGO_MANIFEST_DIR")).join("patches/thesis/fig-8-16.json");
    let one_step = |command: &mut Command| -> Outcome<f64> {
        let (seconds, output) = timed(|| command.output());
        if output?.status.success() { Ok(seconds) } else { Err("patchcord did not run".into()) }
    };
    let mut times = (0..STARTS)
        .map(|_| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_patchcord"));
            one_step(
                command.arg("run").arg(&patch).args(["--for", "2e-5", "--step", "2e-5", "--every", "2e-5"]),
            )
        })
        .collect::<Outcome<Vec<f64>>>()?;
    times.sort_by(f64::total_cmp);
    let row =
        vec![format_seconds(times[0]), format_seconds(times[STARTS / 2]), format_seconds(times[STARTS - 1])];
    Ok(page::table(&["shortest", "median", "longest"], &[row]))
}
