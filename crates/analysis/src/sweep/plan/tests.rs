//! Unit tests of `plan`.

use super::*;
use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Patch;

fn plan(axes: &[&str]) -> Result<Plan, String> {
    let patch = Patch::read("../../patches/thesis/fig-8-16.json").unwrap();
    let program = Program::new(&Circuit::new(&patch).unwrap()).unwrap();
    let axes: Result<Vec<_>, _> = axes.iter().map(|text| Axis::parse(text)).collect();
    axes.and_then(|axes: Vec<Axis>| Plan::new(axes, &program)).map_err(|error| error.to_string())
}

#[test]
fn the_last_axis_changes_fastest() {
    let plan = plan(&["VcL=1e-3:3e-3:3", "Tc=0.01,0.02"]).unwrap();
    assert_eq!((plan.runs(), plan.names().collect::<Vec<_>>()), (6, vec!["VcL", "Tc"]));
    let all: Vec<_> = (0..6).map(|run| plan.values(run)).collect();
    let expected = [[1e-3, 0.01], [1e-3, 0.02], [2e-3, 0.01], [2e-3, 0.02], [3e-3, 0.01], [3e-3, 0.02]];
    assert_eq!(all, expected);
}

#[test]
fn values_with_units_are_converted_to_the_declared_unit() {
    let values = |axis: &str| {
        let plan = plan(&[axis]).unwrap();
        (0..plan.runs()).map(|run| plan.values(run)[0]).collect::<Vec<_>>()
    };
    assert_eq!(values("VcL=2.54mm/s:5.08 mm/s:2"), [2.54e-3, 5.08e-3]);
    assert_eq!(values("Tc=10ms:0.04:2:log"), [0.01, 0.04]);
    assert_eq!(values("VcL=1mm/s,2e-3,0.3 cm/s"), [1e-3, 2e-3, 3e-3]);
    assert_eq!(plan(&["VcL=1mm/s:2mm/s:2"]), plan(&["VcL=1e-3:2e-3:2"]));
}

/// A drive whose frequency n is in rpm and whose amplitude w is in deg/s.
const TURNING: &str = r#"{"patchcord": 1,
    "parameters": {"n": {"value": 120, "unit": "rpm", "range": [1, 1000]},
        "w": {"value": 9, "unit": "deg/s", "range": [1, 90]}},
    "scales": {"speed": {"per_volt": 1, "unit": "deg/s"}},
    "drives": {"shake": {"kind": "sine", "scale": "speed", "amplitude": "w", "frequency": "n"}},
    "elements": {"S": {"kind": "summer", "in": {"x1": ["shake"]}}},
    "signals": {"s": {"at": "S", "scale": "speed"}},
    "run": {"for": 1, "step": 0.01}}"#;

#[test]
fn revolutions_are_not_taken_for_radians() {
    let patch = Patch::parse("turning.json", TURNING).unwrap();
    let program = Program::new(&Circuit::new(&patch).unwrap()).unwrap();
    let values = |axis: &str| {
        let plan = Plan::new([Axis::parse(axis)?], &program)?;
        Ok::<_, PlanError>((0..plan.runs()).map(|run| plan.values(run)[0]).collect::<Vec<_>>())
    };
    assert_eq!(values("n=150 1/min,2.5 1/s,2 Hz,100").unwrap(), [150.0, 150.0, 120.0, 100.0]);
    assert_eq!(values("w=5 rpm,0.1 Hz").unwrap(), [30.0, 36.0]);
    let error = values("w=5 1/s,6").unwrap_err().to_string();
    let expected =
        "w: \"5 1/s\": 1/s cannot be converted to deg/s, because 1/s may count radians, degrees or";
    assert!(error.starts_with(expected), "{error}");
}

#[test]
fn ends_are_exact_and_spacing_is_regular() {
    let values = |axis: &str| {
        let plan = plan(&[axis]).unwrap();
        (0..plan.runs()).map(|run| plan.values(run)[0]).collect::<Vec<_>>()
    };
    let even = values("VcL=1.27e-3:25.4e-3:40");
    assert_eq!((even.len(), even[0], even[39]), (40, 1.27e-3, 25.4e-3));
    assert!(even.windows(2).all(|pair| ((pair[1] - pair[0]) / (24.13e-3 / 39.0) - 1.0).abs() < 1e-12));
    let ratios = values("Tc=0.001:1:7:log");
    assert_eq!((ratios[0], ratios[6]), (0.001, 1.0));
    assert!(ratios.windows(2).all(|pair| (pair[1] / pair[0] / 10f64.sqrt() - 1.0).abs() < 1e-12));
    assert_eq!(values("Tc=0.02:0.01:2"), [0.02, 0.01]);
}

#[test]
fn the_range_between_the_ends_may_overflow() {
    let values = |axis: &str| {
        let axis = Axis::parse(axis).unwrap();
        (0..axis.count()).map(|index| axis.value(index, 0)).collect::<Vec<_>>()
    };
    assert_eq!(values("k=-1e308:1e308:3"), [-1e308, 0.0, 1e308]);
    for axis in ["k=1e300:1e-300:3:log", "k=1e-300:1e300:3:log"] {
        assert!((values(axis)[1] - 1.0).abs() < 1e-12, "{axis}: {:?}", values(axis));
    }
    // Decimal steps are exact: not 1.2999999999999998.
    assert_eq!(values("k=1:2:11")[3], 1.3);
}

#[test]
fn bad_plans_return_errors() {
    let cases: [(&[&str], &str); 18] = [
        (&[], "no parameter is varied"),
        (&["VcL"], "\"VcL\" gives no values: write NAME=FIRST:LAST:COUNT"),
        (&["VcL=1:2:3:4"], "\"VcL=1:2:3:4\" gives no values"),
        (&["VcL=1e-3:fast:3"], "VcL: \"fast\" is not a number"),
        (&["VcL=1e-3,NaN"], "VcL: NaN is not a finite number"),
        (&["VcL=1:3kg:3"], "VcL: \"3kg\" is in kg, but m/s is expected"),
        (&["VcL=1,000,000:2e6:3"], "VcL: \"1,000,000\" is not a number: write 1000000"),
        (
            &["VcL=1e-3,2e-3,"],
            "VcL: a value is missing in \"1e-3,2e-3,\": write a number there, or remove the extra comma",
        ),
        (&["VcL=1e-3::3"], "VcL: a value is missing in \"1e-3::3\": write a number there"),
        (&["VcL="], "VcL: a value is missing in \"\": write a number there"),
        (&["VcL=1e-3:2e-3:1"], "VcL: number of points must be an integer from 2 to 1e9, got \"1\""),
        (&["VcL=1e-3:2e-3:1e12"], "VcL: number of points must be an integer"),
        (&["VcL=1e-3:2e-3:2.5:log"], "VcL: number of points must be an integer"),
        (&["VcL=0:2e-3:5:log"], "VcL: logarithmic spacing needs positive ends"),
        (&["VLc=1e-3:2e-3:5"], "there is no parameter VLc; did you mean \"VcL\"?"),
        (&["VcL=1e-3:1:5"], "VcL = 1 m/s is outside its range 0.000254 ... 0.05 m/s"),
        (&["Tc=1e-2,2e-2", "VcL=1e-3,2e-3", "Tc=3e-2"], "Tc is varied twice"),
        (&["VcL=1e-3:2e-3:100000", "Tc=0.01:0.02:100000"], "the plan has more than 1000000000 runs"),
    ];
    for (axes, expected) in cases {
        let error = plan(axes).unwrap_err();
        assert!(error.starts_with(expected), "{axes:?}: {error}");
    }
}
