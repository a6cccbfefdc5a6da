//! Unit tests of `csv_table`.

use super::reader::{MAX_COLUMNS, MAX_ROWS};
use super::*;

/// Selects the first two columns.
const FIRST_TWO: [ColumnSelector<'_>; 2] = [ColumnSelector::First, ColumnSelector::Next];

fn table(text: &str, selectors: &[ColumnSelector<'_>]) -> Result<CsvTable, Vec<CsvFault>> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), text).unwrap();
    read(file.path(), selectors)
}

fn columns(text: &str, selectors: &[ColumnSelector<'_>]) -> Vec<Vec<f64>> {
    table(text, selectors).unwrap_or_else(|faults| panic!("{faults:?}")).columns
}

#[test]
fn columns_are_selected_by_name_or_by_position() {
    let text = "t,x,v\n0,1,2\n1,3,4\n";
    let named = ColumnSelector::Named;
    assert_eq!(columns(text, &FIRST_TWO), [[0.0, 1.0], [1.0, 3.0]]);
    assert_eq!(columns(text, &[named("t"), named("v")]), [[0.0, 1.0], [2.0, 4.0]]);
    assert_eq!(
        columns(text, &[named("x"), ColumnSelector::Next]),
        [[1.0, 3.0], [2.0, 4.0]],
        "the next column"
    );
    assert_eq!(columns(text, &[named("v"), named("t"), named("v")]), [[2.0, 4.0], [0.0, 1.0], [2.0, 4.0]]);
}

#[test]
fn a_text_gives_the_table_and_the_faults_of_its_file() {
    for text in ["# x: mm\nt (ms),x\n0,1\n1,3\n", "t,x\n0,1\n1,\n2,a\n", "t;x\n0;1\n", "", "t\n0\n"] {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        let [read, parsed] = [read(file.path(), &FIRST_TWO), parse(file.path(), text, &FIRST_TWO)]
            .map(|table| table.map(|table| (table.columns, table.lines, table.names, table.units)));
        assert_eq!(read, parsed, "{text}");
    }
}

#[test]
fn all_columns_of_a_text_are_read_and_words_are_nan() {
    let text = "# t: s\nt,x (mm),x (mm),note\n0,1,2,begin\n1,,4,inf\n";
    let table = parse_all("a.csv", text).unwrap();
    assert_eq!(table.names, ["t", "x (mm)", "x (mm)", "note"]);
    assert_eq!((&table.columns[0], &table.columns[2]), (&vec![0.0, 1.0], &vec![2.0, 4.0]));
    assert_eq!(table.columns[1][..1], [1.0]);
    assert!(table.columns[1][1].is_nan(), "{:?}", table.columns);
    assert!(table.columns[3].iter().all(|number| number.is_nan()), "{:?}", table.columns);
    let units = table.units.iter().map(|unit| unit.as_ref().map(|unit| unit.text.as_str()));
    assert_eq!(units.collect::<Vec<_>>(), [Some("s"), Some("mm"), Some("mm"), None]);
    let faults = parse_all("a.csv", "t,x\n0\n").unwrap_err();
    assert_eq!(faults[0].message, "line 2 of a.csv has 1 field, but the line of names has 2");
    assert_eq!(parse_all("a.csv", "").unwrap_err()[0].message, "a.csv is empty");
}

#[test]
fn a_fault_names_the_column_that_was_selected_by_name() {
    let faults = table("t,x\n0,1\n1,\n", &[ColumnSelector::First, ColumnSelector::Named("x")]).unwrap_err();
    assert!(
        faults[0].message.ends_with("has an empty cell instead of a number, in the column x"),
        "{faults:?}"
    );
}

#[test]
fn every_missing_column_is_reported() {
    let faults = table(
        "t,x\n0,1\n",
        &[ColumnSelector::Named("y"), ColumnSelector::Named("t"), ColumnSelector::Named("z")],
    )
    .unwrap_err();
    let missing: Vec<_> = faults.iter().map(|fault| fault.column).collect();
    assert_eq!(missing, [Some(0), Some(2)], "{faults:?}");
}

#[test]
fn byte_order_marks_line_ends_quotes_blanks_and_comments_are_skipped() {
    let text = "\u{feff}# made by hand\r\n# t: s\r\n# \"force\": N\r\n\"t\",\"a force\"\r\n\r\n0, 1e3\r\n# more\r\n  \r\n\"+.5\", -2";
    let table = table(text, &[ColumnSelector::First, ColumnSelector::Named("a force")]).unwrap();
    assert_eq!((table.columns, table.lines), (vec![vec![0.0, 0.5], vec![1000.0, -2.0]], vec![6, 9]));
    assert_eq!(table.units, [Some(UnitComment { text: "s".to_owned(), line: 2 }), None]);
}

#[test]
fn units_are_in_comments_or_in_names() {
    let text = "# x: mm\n# v (m/s): m/s\nt (ms),x [mm],v (m/s),F,F (N)\n0,1,2,3,4\n";
    let names = ["t", "x", "v (m/s)", "F", "F (N)"];
    let table = table(text, &names.map(ColumnSelector::Named)).unwrap();
    assert_eq!(table.columns, [[0.0], [1.0], [2.0], [3.0], [4.0]]);
    let units: Vec<_> = table.units.iter().flatten().map(|unit| (unit.text.as_str(), unit.line)).collect();
    assert_eq!(units, [("ms", 3), ("mm", 1), ("m/s", 2), ("N", 3)]);
    assert_eq!(table.names[0], "t (ms)");
}

#[test]
fn units_in_full_and_in_other_brackets_are_understood() {
    let text = "# v: mm/sec\nt {msec},x<microns>,v,M (kNm),phi [°],n (rev/min)\n0,1,2,3,4,5\n";
    let names = ["t", "x", "v", "M", "phi", "n"];
    let table = table(text, &names.map(ColumnSelector::Named)).unwrap();
    let units: Vec<_> = table.units.iter().flatten().filter_map(UnitComment::unit).collect();
    let expected = ["ms", "µm", "mm/s", "kN m", "deg", "rpm"].map(|unit| Unit::parse(unit).unwrap());
    assert_eq!(units, expected);
    let texts: Vec<_> = table.units.iter().flatten().map(|unit| unit.text.as_str()).collect();
    assert_eq!(texts, ["msec", "microns", "mm/sec", "kNm", "°", "rev/min"]);
    assert_eq!(UnitComment { text: String::new(), line: 1 }.unit(), None);
}

#[test]
fn a_quotient_of_equal_units_in_a_name_is_the_pure_number() {
    let table = table("t,x (sec/sec)\n0,1\n", &[ColumnSelector::First, ColumnSelector::Next]).unwrap();
    let unit = table.units[1].as_ref().unwrap();
    assert_eq!((unit.text.as_str(), unit.line), ("sec/sec", 1));
    assert!(unit.unit().unwrap().is_same_as(&Unit::parse("1").unwrap()));
}

#[test]
fn a_name_without_its_unit_selects_only_one_column() {
    let selectors = [ColumnSelector::First, ColumnSelector::Named("x")];
    let faults = table("t,x (m),x (mm)\n0,1,1000\n", &selectors).unwrap_err();
    assert!(faults[0].message.ends_with("has more than one column \"x\""), "{faults:?}");
}

/// Message and hint of the only fault of a table, with its path replaced by FILE.
fn only_fault(text: &str) -> String {
    let faults = table(text, &FIRST_TWO).unwrap_err();
    assert_eq!(faults.len(), 1, "{faults:?}");
    let path = faults[0].message.split(' ').find(|word| word.starts_with('/')).unwrap_or_default().to_owned();
    format!("{}; {}", faults[0].message.replace(&path, "FILE"), faults[0].hint)
}

#[test]
fn a_fault_of_a_table_names_its_line() {
    let cases = [
        ("", "FILE is empty"),
        ("# t: s\n\n", "FILE is empty"),
        ("t;x\n0,5;1\n", "line 1 of FILE separates its columns by \";\"; separate the columns"),
        ("t\tx\n0\t1\n", "line 1 of FILE separates its columns by tabs"),
        ("0,1\n1,2\n", "line 1 of FILE has numbers instead of column names"),
        ("t\n0\n", "line 1 of FILE has no column to the right of"),
        ("t,x\n0,5,1,5\n", "line 2 of FILE has 4 fields, but the line of names has 2; write decimal points"),
        ("t,x\n\"0,5\",1\n", "line 2 of FILE has \"0,5\" instead of a number; write 0.5, not 0,5"),
        ("t,x\n0,\n", "line 2 of FILE has an empty cell instead of a number; write a number into the cell"),
        ("t,x\n0,NaN\n", "line 2 of FILE has \"NaN\" instead of a number"),
        ("t,x\n0,1e999\n", "line 2 of FILE has \"1e999\" instead of a number"),
        ("t,x\n\"0,1\n", "line 2 of FILE has 1 field, but the line of names has 2; write one field"),
        ("t,x\r0,1\r", "line 1 of FILE contains a carriage return"),
        (
            "# t: s\nt (ms),x\n0,1\n",
            "line 2 of FILE names a column t (ms), but line 1 gives its unit as s; correct or remove one",
        ),
        ("t\0,\0x\0\n", "line 1 of FILE contains control characters; name a CSV file"),
    ];
    for (text, expected) in cases {
        assert!(only_fault(text).starts_with(expected), "{text:?}: {}", only_fault(text));
    }
}

#[test]
fn bytes_that_are_not_text_are_reported_with_their_line() {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), b"t,x\n0,1\n1,\xe9\n").unwrap();
    let faults = read(file.path(), &FIRST_TWO).unwrap_err();
    assert!(faults[0].message.starts_with("line 3 of ") && faults[0].hint.contains("UTF-8"), "{faults:?}");
}

#[test]
fn only_the_first_ten_faults_are_reported() {
    let faults = table(&format!("t,x\n0,1\n{}", "a,b\n".repeat(1000)), &FIRST_TWO).unwrap_err();
    assert_eq!(faults.len(), MAX_FAULTS);
}

#[test]
fn at_most_one_field_of_a_file_that_is_not_a_table_is_shown() {
    let users = "root:x:0:0:Charlie,,:/root:/bin/sh\nann:x:1:1:Ann,Room 7,:/home/ann:/bin/sh\n";
    let notes = format!("to do,when\n{},today\n{},later\n", "call the office ".repeat(9), "rest");
    for (text, first) in
        [(users, ColumnSelector::Named("t")), (users, ColumnSelector::First), (&notes, ColumnSelector::First)]
    {
        let faults = table(text, &[first, ColumnSelector::Next]).unwrap_err();
        assert_eq!(faults.len(), 1, "{faults:?}");
        let printed = format!("{} {}", faults[0].message, faults[0].hint);
        let confidential = ["Charlie", "Room", "call the office call the office call", "rest"];
        assert!(!confidential.iter().any(|part| printed.contains(part)), "{printed}");
    }
}

#[test]
fn a_folder_and_a_table_with_too_many_rows_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let faults = read(folder.path(), &FIRST_TWO).unwrap_err();
    assert!(faults[0].message.ends_with(": it is a folder"), "{faults:?}");
    let endless = "t,x\n".to_owned() + &"0,1\n".repeat(MAX_ROWS + 1);
    assert!(only_fault(&endless).contains("the limit of 2000000 rows"), "{}", only_fault(&endless));
}

#[test]
fn more_than_10000_columns_are_refused_in_the_line_of_names_and_in_a_row() {
    let names: Vec<_> = (0..MAX_COLUMNS).map(|index| format!("c{index}")).collect();
    let allowed = format!("{}\n{}0\n", names.join(","), "0,".repeat(MAX_COLUMNS - 1));
    assert_eq!(columns(&allowed, &FIRST_TWO), [[0.0], [0.0]]);
    let wide = format!("{},c\n0\n", names.join(","));
    assert!(only_fault(&wide).starts_with("line 1 of FILE has more than 10000 columns; use fewer columns"));
    let quoted = format!("\"t\"{}\n0\n", ",x".repeat(MAX_COLUMNS));
    assert!(only_fault(&quoted).starts_with("line 1 of FILE has more than 10000 columns"));
    let row = format!("t,x\n{}0\n", "0,".repeat(MAX_COLUMNS));
    assert!(only_fault(&row).starts_with("line 2 of FILE has more than 10000 columns"));
}

#[test]
fn a_line_above_10_mb_is_refused() {
    let line = "x".repeat(MAX_LINE_BYTES + 1);
    assert!(only_fault(&line).starts_with("line 1 of FILE has more than 10 MB"));
    assert!(only_fault(&format!("t,x\n0,1\n{line}")).starts_with("line 3 of FILE has more than 10 MB"));
}

#[test]
fn more_than_10000_comment_lines_with_a_colon_are_refused_in_front_of_the_names() {
    let comments = "# a: b\n".repeat(MAX_COLUMNS);
    assert_eq!(columns(&format!("{comments}t,x\n0,1\n# a: b\n"), &FIRST_TWO), [[0.0], [1.0]]);
    let fault = only_fault(&format!("{comments}# a: b\nt,x\n0,1\n"));
    assert!(fault.starts_with("line 10001 of FILE exceeds the limit of 10000 comment lines"), "{fault}");
}

#[test]
fn a_selected_column_with_a_name_above_200_characters_is_refused() {
    let name = "x".repeat(201);
    let faults = table(&format!("t,{name}\n0,1\n"), &[ColumnSelector::Named(&name)]).unwrap_err();
    assert!(faults[0].message.ends_with("has a column name of more than 200 characters"), "{faults:?}");
    assert_eq!(faults[0].column, Some(0));
    // Other columns may have a name of any length.
    assert_eq!(columns(&format!("t,{name}\n0,1\n"), &[ColumnSelector::First]), [[0.0]]);
}

#[cfg(unix)]
#[test]
fn a_link_to_a_device_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("zero.csv");
    std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
    let faults = read(&link, &FIRST_TWO).unwrap_err();
    assert!(faults[0].message.ends_with(": it is a device, not a regular file"), "{faults:?}");
}
