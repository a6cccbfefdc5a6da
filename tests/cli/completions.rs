//! `patchcord completions`: scripts that complete commands and options in shells.

use super::{code, errors, out, patchcord};

#[test]
fn every_shell_gets_every_command_and_option() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = out(&patchcord(&["completions", shell]));
        for word in ["check", "run", "elements", "machines", "new", "hold-on-overload", "voltages"] {
            assert!(script.contains(word), "the script for {shell} lacks {word}");
        }
    }
}

/// The completions that bash offers for the last word.
#[cfg(unix)]
fn offered(words: &str) -> Vec<String> {
    let script = out(&patchcord(&["completions", "bash"]));
    let count = words.split_whitespace().count();
    let asks = format!(
        "{script}\nCOMP_WORDS=({words}); COMP_CWORD={}\n_patchcord patchcord \"${{COMP_WORDS[-1]}}\" \"${{COMP_WORDS[-2]}}\"\n\
         printf '%s\\n' \"${{COMPREPLY[@]}}\"\n",
        count - 1
    );
    let bash = assert_cmd::Command::new("bash").args(["--norc", "-s"]).write_stdin(asks).output().unwrap();
    assert_eq!((code(&bash), errors(&bash).as_str()), (0, ""));
    out(&bash).lines().map(str::to_owned).collect()
}

#[cfg(unix)]
#[test]
fn bash_completes() {
    assert_eq!(offered("patchcord che"), ["check"]);
    assert_eq!(offered("patchcord run --hold"), ["--hold-on-overload"]);
    assert_eq!(offered("patchcord completions f"), ["fish"]);
    assert_eq!(offered("patchcord run a.json --backend n"), ["native"]);
}
