//! Why the server closes a WebSocket: codes, and messages that the page shows. A message has at most 123 bytes.

use axum::extract::ws::{CloseFrame, Utf8Bytes, close_code};

use crate::service::{Purpose, Service};

/// The reason if there are as many as permitted.
pub(crate) fn too_many(service: &Service) -> CloseFrame {
    let max = service.max;
    let reason = match service.purpose {
        Purpose::Session => {
            format!("{max} panels are open, which is the most: close another one, then reload this page")
        }
        Purpose::Comparison => format!(
            "{max} panels compare measured data, which is the most: close the data in another one, then open them again"
        ),
    };
    CloseFrame { code: close_code::AGAIN, reason: reason.into() }
}

/// The reason if a worker cannot begin or has ended by a fault of the program.
pub(crate) fn stopped(purpose: Purpose) -> CloseFrame {
    let reason = match purpose {
        Purpose::Session => "the session stopped by a fault of the program: reload this page",
        Purpose::Comparison => {
            "the comparison stopped by a fault of the program: open the measured data again"
        }
    };
    fixed(close_code::ERROR, reason)
}

/// The reason if a page sent nothing for a long time.
pub(crate) fn silent(purpose: Purpose) -> CloseFrame {
    let reason = match purpose {
        Purpose::Session => "the panel was not in use: reload this page to continue",
        Purpose::Comparison => "the measured data were not in use: open them again to continue",
    };
    fixed(close_code::AWAY, reason)
}

/// The reason if a message could not be read.
pub(crate) fn invalid() -> CloseFrame {
    fixed(close_code::POLICY, "a message to patchcord was too large or not valid: use a smaller file")
}

/// The reason if a message is not a request.
pub(crate) fn unsupported() -> CloseFrame {
    fixed(close_code::UNSUPPORTED, "a request must be a text message")
}

/// A reason without numbers.
fn fixed(code: u16, reason: &'static str) -> CloseFrame {
    CloseFrame { code, reason: Utf8Bytes::from_static(reason) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;

    #[test]
    fn every_reason_fits_into_a_message_that_closes() {
        let reasons = [Purpose::Session, Purpose::Comparison].into_iter().flat_map(|purpose| {
            let service =
                Service::new(purpose, &Limits { sessions: 9999, comparisons: 9999, ..Limits::default() });
            [too_many(&service), stopped(purpose), silent(purpose), invalid(), unsupported()]
        });
        for CloseFrame { reason, .. } in reasons {
            assert!(reason.len() <= 123, "{}: {reason}", reason.len());
        }
    }
}
