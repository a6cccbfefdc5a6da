//! Where the probes of the scopes are when a patch is opened.

use patchcord_core::patch::{Patch, PictureSpec};

use crate::scope::{CHANNELS, Channel, Display, SCOPES, Scope, ScopeControls};
use crate::wiring;

/// The name of time along the horizontal axis of a picture.
const TIME: &str = "t";

/// The controls with which the scopes begin: scope 1 shows the first signals against time, as the pictures of the patch
/// do. Scope 2 shows the first X-Y picture, or else the next signals.
pub fn usual_scopes(patch: &Patch) -> [ScopeControls; SCOPES] {
    let against_time = patch.pictures.iter().filter(|picture| picture.x.value == TIME);
    let mut signals: Vec<&str> = against_time.flat_map(ordinates).collect();
    signals.extend(patch.signals.keys().map(String::as_str));
    signals.extend(wiring::section_names(patch));
    let mut outputs: Vec<String> = Vec::new();
    for output in signals.into_iter().filter_map(|name| output_of(patch, name)) {
        if !outputs.contains(&output) {
            outputs.push(output);
        }
        if outputs.len() == SCOPES * CHANNELS {
            break;
        }
    }
    let curve = patch.pictures.iter().find(|picture| picture.x.value != TIME);
    let curve = curve.and_then(|picture| {
        let y = ordinates(picture).next()?;
        Some([output_of(patch, &picture.x.value)?, output_of(patch, y)?])
    });
    let mut outputs = outputs.into_iter().map(Some).chain(std::iter::repeat(None));
    let first = controls(Display::Time, [outputs.next().flatten(), outputs.next().flatten()]);
    let second = match curve {
        Some(axes) => controls(Display::Plane, axes.map(Some)),
        None => controls(Display::Time, [outputs.next().flatten(), outputs.next().flatten()]),
    };
    [first, second]
}

/// The output at which the voltmeter begins: that of the first signal. `None` if the patch has no signals.
pub fn usual_meter(patch: &Patch) -> Option<String> {
    output_of(patch, patch.signals.keys().next()?)
}

/// The names along the vertical axis of a picture.
fn ordinates(picture: &PictureSpec) -> impl Iterator<Item = &str> {
    picture.y.iter().map(|name| name.value.as_str())
}

/// The output at which a signal is read, or the output of this name, by its name at the panel.
fn output_of(patch: &Patch, name: &str) -> Option<String> {
    let element = patch.signals.get(name).map_or(name, |signal| &signal.element.value);
    let outputs = wiring::outputs(patch);
    outputs
        .into_iter()
        .find(|output| output.element == element || output.name == element)
        .map(|output| output.name)
}

/// The usual controls with probes at these outputs.
fn controls(display: Display, outputs: [Option<String>; 2]) -> ScopeControls {
    let usual = Scope::new().controls().clone();
    let mut channels = usual.channels.clone();
    for (channel, output) in channels.iter_mut().zip(outputs) {
        *channel = Channel { output, ..channel.clone() };
    }
    ScopeControls { display, channels, ..usual }
}
