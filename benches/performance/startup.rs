//! From the start of the process to the first step of Fig 8.16, and to the end of the process.

use std::path::Path;
use std::process::Command;

use crate::clock::{timed, told};
use crate::{Outcome, page};

/// How often it is started.
const TIMES: usize = 40;

pub fn table() -> Outcome<String> {
    let patch = Path::new(env!("CARGO_MANIFEST_DIR")).join("patches/thesis/fig-8-16.json");
    let one_step = |command: &mut Command| -> Outcome<f64> {
        let (seconds, output) = timed(|| command.output());
        if output?.status.success() { Ok(seconds) } else { Err("patchcord did not run".into()) }
    };
    let mut times = (0..TIMES)
        .map(|_| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_patchcord"));
            one_step(
                command.arg("run").arg(&patch).args(["--for", "2e-5", "--step", "2e-5", "--every", "2e-5"]),
            )
        })
        .collect::<Outcome<Vec<f64>>>()?;
    times.sort_by(f64::total_cmp);
    let row = vec![told(times[0]), told(times[TIMES / 2]), told(times[TIMES - 1])];
    Ok(page::table(&["shortest", "median", "longest"], &[row]))
}
