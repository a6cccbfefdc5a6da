//! Lists the effects that are part of the program: every file of `patches/effects`.

use std::path::Path;
use std::{env, fs};

const EFFECTS: &str = "../../patches/effects";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed={EFFECTS}");
    let folder = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join(EFFECTS);
    let entries = fs::read_dir(&folder)?.collect::<Result<Vec<_>, _>>()?;
    let mut files: Vec<_> = entries.into_iter().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "json"));
    files.sort();
    // The path is completed when the list is compiled, so the list stays valid if the checkout is moved.
    let row = |file: &std::path::PathBuf| {
        let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let path = format!("/{EFFECTS}/{name}");
        format!("    ({name:?}, include_str!(concat!(env!(\"CARGO_MANIFEST_DIR\"), {path:?}))),\n")
    };
    let rows: String = files.iter().map(row).collect();
    let out = Path::new(&env::var("OUT_DIR")?).join("effects.rs");
    fs::write(out, format!("&[\n{rows}]\n"))?;
    Ok(())
}
