//! The pictures in docs equal those that the commands draw.

use std::fs;

use super::linearise::FIG_8_04;
use super::sensitivity::BALL;
use super::slideway::SLIDEWAY;
use super::{FIG_8_16, code, patchcord, path};

const COULOMB: &str = "patches/thesis/fig-8-16-coulomb.json";
const LAG_LAST: &str = "patches/thesis/fig-8-16-lag-last.json";
const SINGH: &str = "patches/others/singh.json";
const NAKASHIMA: &str = "patches/others/nakashima.json";
const FOUND: &str = "crates/ident/tests/story/found.json";
const BOTH: &str = "patches/thesis/fig-8-16-both.json";

/// Commands and their pictures. `tests/lessons` checks the pictures of the lessons.
const PICTURES: [(&[&str], &str); 17] = [
    (&["run", FIG_8_16], "fig-8-16.svg"),
    (&["run", COULOMB], "fig-8-16-coulomb.svg"),
    (&["run", BOTH], "fig-8-16-both.svg"),
    (&["profile", FIG_8_16], "fig-8-16.profile.svg"),
    (&["draw", FIG_8_16], "fig-8-16.schematic.svg"),
    (&["linearise", FIG_8_04, "--from", "v_i", "--to", "v_o"], "fig-8-04.bode.svg"),
    (&["run", BALL, "--sensitivity", "e,g,h0"], "bouncing-ball.sensitivity.svg"),
    (&["draw", FIG_8_16, "--board"], "fig-8-16.board.svg"),
    (&["run", LAG_LAST], "fig-8-16-lag-last.svg"),
    (&["run", SINGH], "singh.svg"),
    (&["run", NAKASHIMA], "nakashima.svg"),
    (&["run", NAKASHIMA, "--set", "v_set=9e-3"], "nakashima.steady.svg"),
    (&["draw", NAKASHIMA], "nakashima.schematic.svg"),
    (&SLIDEWAY, "slideway.svg"),
    (&["run", FIG_8_04, "--set", "M=433", "--set", "K=45e6", "--set", "f=10.7e3"], "story.linear.svg"),
    (&["run", FOUND], "story.svg"),
    (&["draw", FOUND], "story.schematic.svg"),
];

#[test]
#[ignore = "takes several seconds: every picture of the docs"]
fn the_pictures_in_docs_are_up_to_date() {
    let folder = tempfile::tempdir().unwrap();
    for (command, name) in PICTURES {
        let fresh = path(&folder, name);
        assert_eq!(code(&patchcord(&[command, &["--plot", &fresh]].concat())), 0);
        let (stored, fresh) = (format!("docs/pictures/{name}"), fs::read(&fresh).unwrap());
        if std::env::var_os("PATCHCORD_BLESS").is_some() {
            fs::write(&stored, &fresh).unwrap();
        }
        let hint = "PATCHCORD_BLESS=1 cargo test -p patchcord rewrites it";
        assert!(fs::read(&stored).unwrap_or_default() == fresh, "{stored} is stale: {hint}");
    }
}
