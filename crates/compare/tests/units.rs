//! Columns in other units than those of the patch.

use serde_json::{Value, json};

use crate::files::{begin, compared, comparison, event, example, numbers};

/// The data of the spring with times in ms and positions in m, in names or in comments.
fn converted(head: &str) -> String {
    let data = example("measured.csv");
    let rows = data.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()));
    let row = |line: &str| {
        let (time, position) = line.split_once(',').unwrap();
        let [time, position] = [time, position].map(|number| number.parse::<f64>().unwrap());
        format!("{:.0},{:.12}\n", time * 1e3, position * 1e-3)
    };
    format!("{head}\n{}", rows.map(row).collect::<String>())
}

/// The curves of the spring with these data.
fn curves(data: &str) -> Value {
    let (_, events) = compared(&example("spring.json"), data, &json!({"fit": ["k"]}));
    assert_eq!(events[1]["event"], "curves", "{events:?}");
    events[1]["outputs"][0].clone()
}

#[test]
fn units_of_columns_are_converted() {
    let expected = curves(&example("measured.csv"));
    for head in ["t (ms),x (m)", "# time: ms\n# x: m\ntime,x"] {
        let output = curves(&converted(head));
        assert_eq!(output["unit"], "mm");
        for key in ["time", "measured", "simulated", "residual"] {
            for (value, expected) in numbers(&output, key).into_iter().zip(numbers(&expected, key)) {
                assert!((value - expected).abs() < 2e-3, "{head} {key}: {value} instead of {expected}");
            }
        }
    }
}

#[test]
fn the_unit_of_a_time_can_be_selected() {
    let data = converted("t_ms,x [m]");
    let columns = event(&mut comparison(), &begin(&example("spring.json"), &data));
    assert_eq!(columns["experiment"]["time"], "t_ms");
    let changes = json!({"time": {"column": "t_ms", "unit": "ms"}, "fit": ["k"]});
    let (_, events) = compared(&example("spring.json"), &data, &changes);
    let time = numbers(&events[1]["outputs"][0], "time");
    assert!((time[400] - 8.0).abs() < 1e-9, "{}", time[400]);
}
