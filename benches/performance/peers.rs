//! The peers: other programs that solve the same equations. Each takes `method= setting= for= out=`, writes the output
//! velocity every 1 ms to a file and tells the seconds that solving took.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use serde_json::Value;

use crate::Outcome;
use crate::clock::timed;
use crate::own::COMPARED;

/// Where the peers are built and write.
pub struct Peers {
    folder: PathBuf,
    /// Programs of PATH, and whether they can be used.
    scipy: bool,
    pathsim: bool,
    ngspice: bool,
    crate_built: bool,
}

/// What a peer made of the first seconds.
pub struct Solved {
    pub seconds: f64,
    pub velocity: Vec<f64>,
}

/// Settings of a sweep: 40 of VcL by 25 of Tc.
pub const RUNS: usize = 1000;

fn source(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peers").join(name)
}

/// What a program prints, once it ended well.
fn printed(command: &mut Command) -> Outcome<String> {
    let output = command.output()?;
    if !output.status.success() {
        return Err(format!("{command:?}: {}", String::from_utf8_lossy(&output.stderr)).into());
    }
    Ok(String::from_utf8(output.stdout)?)
}

/// Whether a program runs; tells what is missing otherwise.
fn found(what: &str, command: &mut Command) -> bool {
    let there = printed(command).is_ok();
    if !there {
        eprintln!("{what} is not installed here: left out");
    }
    there
}

fn doubles(path: &Path) -> Outcome<Vec<f64>> {
    let bytes = fs::read(path)?;
    Ok(bytes.chunks_exact(8).map(|bytes| f64::from_ne_bytes(bytes.try_into().expect("8 bytes"))).collect())
}

impl Peers {
    /// Builds the C programs and the Rust one, and looks for the others.
    pub fn built() -> Outcome<Peers> {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("performance");
        fs::create_dir_all(&folder)?;
        for stem in ["fig_8_16", "fig_8_16_located"] {
            let mut cc = Command::new("cc");
            cc.args(["-O3", "-march=native", "-o"]).arg(folder.join(stem)).arg(source(&format!("{stem}.c")));
            printed(cc.arg("-lm"))?;
        }
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["build", "--release", "--manifest-path"]).arg(source("rust/Cargo.toml"));
        cargo.arg("--target-dir").arg(folder.join("rust"));
        Ok(Peers {
            scipy: found("SciPy", Command::new("python3").args(["-c", "import scipy"])),
            pathsim: found("PathSim", Command::new("python3").args(["-c", "import pathsim"])),
            ngspice: found("ngspice", Command::new("ngspice").arg("--version")),
            crate_built: found("the crate ode_solvers", &mut cargo),
            folder,
        })
    }

    /// Whether a peer can be used here.
    pub fn has(&self, program: Program) -> bool {
        match program {
            Program::Crate => self.crate_built,
            Program::Scipy => self.scipy,
            Program::Pathsim => self.pathsim,
            Program::Ngspice => self.ngspice,
        }
    }

    /// What everything was measured on, and with.
    pub fn versions(&self) -> String {
        let first = |program: &str, words: &[&str]| {
            let text = printed(Command::new(program).args(words)).unwrap_or_default();
            let line = text.lines().map(|line| line.trim_matches(['*', ' '])).find(|line| !line.is_empty());
            line.unwrap_or("not installed").to_owned()
        };
        let version = |module: &str| {
            first("python3", &["-c", &format!("import {module}; print({module}.__version__)")])
        };
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
        let load = load.split_whitespace().next().unwrap_or("not known").to_owned();
        let lines = [
            format!(
                "* processor: {}, {cores} cores; programs that ran beside (load average): {load}",
                processor()
            ),
            format!("* {}; {}", first("rustc", &["--version"]), first("cc", &["--version"])),
            format!(
                "* SciPy {}, PathSim {}, {}",
                version("scipy"),
                version("pathsim"),
                first("python3", &["--version"])
            ),
            format!("* {}", first("ngspice", &["--version"])),
            format!("* ode_solvers {}", crate_version().unwrap_or_default()),
        ];
        lines.join("\n") + "\n"
    }

    /// What a C program printed.
    fn c(&self, stem: &str, words: &[String]) -> Outcome<Value> {
        Ok(serde_json::from_str(&printed(Command::new(self.folder.join(stem)).args(words))?)?)
    }

    /// Seconds of the C program for a length at a step.
    pub fn c_seconds(&self, stem: &str, length: f64, step: f64) -> Outcome<f64> {
        let told = self.c(stem, &[format!("step={step:e}"), format!("for={length}")])?;
        told["seconds"].as_f64().ok_or("no seconds".into())
    }

    /// A C program over the first seconds.
    pub fn c_solved(&self, stem: &str, step: f64) -> Outcome<Solved> {
        let rows = self.folder.join("rows");
        let words = [format!("step={step:e}"), format!("for={COMPARED}")];
        let told = self.c(stem, &[&words[..], &[format!("rows={}", rows.display())]].concat())?;
        // Seven signals a row, the velocity the third.
        let velocity = doubles(&rows)?.chunks_exact(7).map(|row| row[2]).collect();
        Ok(Solved { seconds: told["seconds"].as_f64().ok_or("no seconds")?, velocity })
    }

    /// A C program over all settings of the sweep, one after the other.
    pub fn c_swept(&self, stem: &str, step: f64) -> Outcome<Solved> {
        let rows = self.folder.join("sweep");
        let words =
            [format!("step={step:e}"), format!("for={COMPARED}"), format!("sweep={}", rows.display())];
        let told = self.c(stem, &words)?;
        Ok(Solved { seconds: told["seconds"].as_f64().ok_or("no seconds")?, velocity: doubles(&rows)? })
    }

    /// A peer that takes a method and a setting.
    pub fn solved(&self, program: Program, method: &str, setting: f64) -> Outcome<Solved> {
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
        let told: Value = serde_json::from_str(&printed(&mut command)?)?;
        Ok(Solved { seconds: told["seconds"].as_f64().ok_or("no seconds")?, velocity: doubles(&out)? })
    }

    /// ngspice with a longest step: the whole process, reading the circuit and writing included.
    fn ngspice(&self, method: &str, longest: f64) -> Outcome<Solved> {
        let (deck, out) = (self.folder.join("fig_8_16.cir"), self.folder.join("velocity.txt"));
        let control = format!(
            ".options method={method} reltol=1e-6 abstol=1e-12 vntol=1e-9 chgtol=1e-15\n.control\nset wr_singlescale\n\
             save v(v)\ntran 1m {COMPARED} 0 {longest:e} uic\nlinearize v(v)\nwrdata {} v(v)\nquit\n.endc\n.end\n",
            out.display()
        );
        fs::write(&deck, fs::read_to_string(source("fig_8_16.cir"))? + &control)?;
        let (seconds, ended) = timed(|| printed(Command::new("ngspice").arg("-b").arg(&deck)));
        ended?;
        let millimetres = fs::read_to_string(&out)?;
        let velocity = millimetres
            .lines()
            .filter_map(|line| Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? * 1e-3));
        Ok(Solved { seconds, velocity: velocity.collect() })
    }
}

/// Peers that take a method and a setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Program {
    Crate,
    Scipy,
    Pathsim,
    Ngspice,
}

impl Program {
    fn script(self) -> Option<&'static str> {
        match self {
            Program::Scipy => Some("scipy_fig_8_16.py"),
            Program::Pathsim => Some("pathsim_fig_8_16.py"),
            Program::Crate | Program::Ngspice => None,
        }
    }
}

fn processor() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let of = |key: &str| {
        let line = text.lines().find(|line| line.starts_with(key))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    let told = [of("model name"), of("cpu family").map(|family| format!("family {family}"))];
    told.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn crate_version() -> Option<String> {
    let lock = fs::read_to_string(source("rust/Cargo.lock")).ok()?;
    let after = lock.split_once("name = \"ode_solvers\"\nversion = \"")?.1;
    Some(after.split('"').next()?.to_owned())
}
