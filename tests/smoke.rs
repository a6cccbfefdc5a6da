use patchcord::{circuit::Circuit, patch::Patch, program::Program, solve};
#[test]
fn smoke() {
    let patch = Patch::read("patches/thesis/fig-8-16.json".as_ref()).unwrap();
    let circuit = Circuit::new(&patch, &[]).unwrap_or_else(|r| panic!("{r}"));
    println!("{}", circuit.warnings());
    for row in circuit.scaling() {
        println!("{row:?} {:?}", row.difference());
    }
    let program = Program::new(&circuit).unwrap_or_else(|r| panic!("{r}"));
    println!("{} ops", program.body().len());
    let m = solve::Machine::new(&program, 2e-5).unwrap();
    for e in program.outlets() {
        println!("{} {}", e.name, m.voltage(&e.name).unwrap());
    }
    let s = solve::RunSettings::of(&circuit).unwrap();
    let t0 = std::time::Instant::now();
    let trace = solve::run(&program, &s).unwrap();
    println!("{:?}", t0.elapsed());
    for track in &trace.tracks {
        println!(
            "{} {:?}",
            track.name,
            track.values().fold((f64::MAX, f64::MIN), |a, v| (a.0.min(v), a.1.max(v)))
        );
    }
    println!("{:?}", trace.sweeps);
}
