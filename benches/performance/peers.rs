//! The peers: other programs that solve the same equations (benches/peers).
//!
//! Each takes `method= setting= for= out=`, writes the output velocity every 1 ms to a file, and prints the duration of
//! solving in s as JSON.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use serde_json::Value;

use crate::Outcome;
use crate::backends::COMPARED;
use crate::timing::timed;

/// The folder of the built peers, and which peers are available.
pub(crate) struct Peers {
    /// Built programs and their output.
    folder: PathBuf,
    /// Whether the python3 of the path has SciPy.
    scipy: bool,
    /// Whether the python3 of the path has PathSim.
    pathsim: bool,
    ngspice: bool,
    /// Whether the Rust program with the crate ode_solvers could be built.
    ode_solvers: bool,
}

/// A solution over the compared duration.
pub(crate) struct Solved {
    /// Duration of solving in s.
    pub seconds: f64,
    /// Output velocity in m/s every 1 ms.
    pub velocity: Vec<f64>,
}

/// Runs of a sweep: 40 values of VcL by 25 of Tc.
pub(crate) const RUNS: usize = 1000;

/// The path of a source file of a peer.
fn source(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peers").join(name)
}

/// The standard output of a program. An error contains its standard error.
fn output_of(command: &mut Command) -> Outcome<String> {
    let output = command.output()?;
    if !output.status.success() {
        return Err(format!("{command:?}: {}", String::from_utf8_lossy(&output.stderr)).into());
    }
    Ok(String::from_utf8(output.stdout)?)
}

/// Whether a program runs. If not, a line on standard error says that it is omitted.
fn is_available(name: &str, command: &mut Command) -> bool {
    let is_available = output_of(command).is_ok();
    if !is_available {
        eprintln!("{name} is not installed: omitted");
    }
    is_available
}

/// The numbers of a file of native doubles.
fn doubles(path: &Path) -> Outcome<Vec<f64>> {
    let bytes = fs::read(path)?;
    Ok(bytes.chunks_exact(8).map(|bytes| f64::from_ne_bytes(bytes.try_into().expect("8 bytes"))).collect())
}

impl Peers {
    /// Builds the C programs and the Rust program, and tests which other peers are installed.
    ///
    /// # Errors
    ///
    /// If a C program cannot be built.
    pub(crate) fn build() -> Outcome<Peers> {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("performance");
        fs::create_dir_all(&folder)?;
        for stem in ["fig_8_16", "fig_8_16_located"] {
            let mut cc = Command::new("cc");
            cc.args(["-O3", "-march=native", "-o"]).arg(folder.join(stem)).arg(source(&format!("{stem}.c")));
            output_of(cc.arg("-lm"))?;
        }
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["build", "--release", "--manifest-path"]).arg(source("rust/Cargo.toml"));
        cargo.arg("--target-dir").arg(folder.join("rust"));
        Ok(Peers {
            scipy: is_available("SciPy", Command::new("python3").args(["-c", "import scipy"])),
            pathsim: is_available("PathSim", Command::new("python3").args(["-c", "import pathsim"])),
            ngspice: is_available("ngspice", Command::new("ngspice").arg("--version")),
            ode_solvers: is_available("the crate ode_solvers", &mut cargo),
            folder,
        })
    }

    /// Whether a peer can be used here.
    pub(crate) fn has(&self, program: Program) -> bool {
        match program {
            Program::Crate => self.ode_solvers,
            Program::Scipy => self.scipy,
            Program::Pathsim => self.pathsim,
            Program::Ngspice => self.ngspice,
        }
    }

    /// The processor, the load and the versions of all programs, as a Markdown list.
    pub(crate) fn versions(&self) -> String {
        let first_line = |program: &str, words: &[&str]| {
            let text = output_of(Command::new(program).args(words)).unwrap_or_default();
            let line = text.lines().map(|line| line.trim_matches(['*', ' '])).find(|line| !line.is_empty());
            line.unwrap_or("not installed").to_owned()
        };
        let version = |module: &str| {
            first_line("python3", &["-c", &format!("import {module}; print({module}.__version__)")])
        };
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
        let load = load.split_whitespace().next().unwrap_or("unknown").to_owned();
        let lines = [
            format!("* processor: {}, {cores} cores; load average {load}", processor()),
            format!("* {}; {}", first_line("rustc", &["--version"]), first_line("cc", &["--version"])),
            format!(
                "* SciPy {}, PathSim {}, {}",
                version("scipy"),
                version("pathsim"),
                first_line("python3", &["--version"])
            ),
            format!("* {}", first_line("ngspice", &["--version"])),
            format!("* ode_solvers {}", crate_version().unwrap_or_default()),
        ];
        lines.join("\n") + "\n"
    }

    /// The JSON that a C program prints.
    fn run_c(&self, stem: &str, words: &[String]) -> Outcome<Value> {
        Ok(serde_json::from_str(&output_of(Command::new(self.folder.join(stem)).args(words))?)?)
    }

    /// Duration in s of a run of a C program over `length` with a step, both in s.
    pub(crate) fn c_seconds(&self, stem: &str, length: f64, step: f64) -> Outcome<f64> {
        let report = self.run_c(stem, &[format!("step={step:e}"), format!("for={length}")])?;
        report["seconds"].as_f64().ok_or("no seconds".into())
    }

    /// The solution of a C program over the compared duration.
    pub(crate) fn solve_in_c(&self, stem: &str, step: f64) -> Outcome<Solved> {
        let rows = self.folder.join("rows");
        let words = [format!("step={step:e}"), format!("for={COMPARED}")];
        let report = self.run_c(stem, &[&words[..], &[format!("rows={}", rows.display())]].concat())?;
        // A row has seven signals. The velocity is the third.
        let velocity = doubles(&rows)?.chunks_exact(7).map(|row| row[2]).collect();
        Ok(Solved { seconds: report["seconds"].as_f64().ok_or("no seconds")?, velocity })
    }

    /// The solutions of a C program for all runs of the sweep, one after the other.
    pub(crate) fn sweep_in_c(&self, stem: &str, step: f64) -> Outcome<Solved> {
        let rows = self.folder.join("sweep");
        let words =
            [format!("step={step:e}"), format!("for={COMPARED}"), format!("sweep={}", rows.display())];
        let report = self.run_c(stem, &words)?;
        Ok(Solved { seconds: report["seconds"].as_f64().ok_or("no seconds")?, velocity: doubles(&rows)? })
    }

    /// The solution of a peer with a method and a setting: a tolerance or a step in s.
    pub(crate) fn solve(&self, program: Program, method: &str, setting: f64) -> Outcome<Solved> {
        if program == Program::Ngspice {
            return self.ngspice(method, setting);
        }
        let out = self.folder.join("velocity");
        let mut command = match program {
            Program::Crate => Command::new(self.folder.join("rust/release/fig-8-16")),
            _ => Command::new("python3"),
        };
        if let Some(script) = program.script() {
            command.arg(source(script));
        }
        command.arg(format!("method={method}")).arg(format!("setting={setting:e}"));
        command.arg(format!("for={COMPARED}")).arg(format!("out={}", out.display()));
        let report: Value = serde_json::from_str(&output_of(&mut command)?)?;
        Ok(Solved { seconds: report["seconds"].as_f64().ok_or("no seconds")?, velocity: doubles(&out)? })
    }

    /// The solution of ngspice with a longest step in s. The duration includes reading the circuit and writing.
    fn ngspice(&self, method: &str, longest: f64) -> Outcome<Solved> {
        let (deck, out) = (self.folder.join("fig_8_16.cir"), self.folder.join("velocity.txt"));
        let control = format!(
            ".options method={method} reltol=1e-6 abstol=1e-12 vntol=1e-9 chgtol=1e-15\n.control\nset wr_singlescale\n\
             save v(v)\ntran 1m {COMPARED} 0 {longest:e} uic\nlinearize v(v)\nwrdata {} v(v)\nquit\n.endc\n.end\n",
            out.display()
        );
        fs::write(&deck, fs::read_to_string(source("fig_8_16.cir"))? + &control)?;
        let (seconds, output) = timed(|| output_of(Command::new("ngspice").arg("-b").arg(&deck)));
        output?;
        let millimetres = fs::read_to_string(&out)?;
        let velocity = millimetres
            .lines()
            .filter_map(|line| Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? * 1e-3));
        Ok(Solved { seconds, velocity: velocity.collect() })
    }
}

/// The peers that take a method and a setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Program {
    Crate,
    Scipy,
    Pathsim,
    Ngspice,
}

impl Program {
    /// The Python script of a peer. `None` if it has none.
    fn script(self) -> Option<&'static str> {
        match self {
            Program::Scipy => Some("scipy_fig_8_16.py"),
            Program::Pathsim => Some("pathsim_fig_8_16.py"),
            Program::Crate | Program::Ngspice => None,
        }
    }
}

/// Model and family of the processor, from /proc/cpuinfo.
fn processor() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let of = |key: &str| {
        let line = text.lines().find(|line| line.starts_with(key))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    let parts = [of("model name"), of("cpu family").map(|family| format!("family {family}"))];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// The version of ode_solvers in the lock file.
fn crate_version() -> Option<String> {
    let lock = fs::read_to_string(source("rust/Cargo.lock")).ok()?;
    let after = lock.split_once("name = \"ode_solvers\"\nversion = \"")?.1;
    Some(after.split('"').next()?.to_owned())
}
