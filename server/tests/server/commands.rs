//! Commands of the program, run as a user runs them.

use crate::run;
use binnacle_server_testing::program::{assert_refused, command, good, samples_csv};
use serde_json::{Value, json};

#[test]
fn field_prints_the_earths_field() {
    let folder = tempfile::tempdir().unwrap();
    let place = ["field", "--lat", "80", "--lon", "0", "--date", "2025.0"];
    let more = ["--model", "wmm2025"];
    let output = run(folder.path(), &[&place[..], &more].concat());
    let field: Value = serde_json::from_str(&good(&output)).unwrap();
    // NOAA's first test value for WMM2025.
    assert!(
        (field["x_nt"].as_f64().unwrap() - 6521.6).abs() < 0.1,
        "{field}"
    );
    assert!((field["declination_deg"].as_f64().unwrap() - 1.28).abs() < 0.01);
    assert_eq!(field["model"], "wmm2025");
}

#[test]
fn deviation_reads_the_output_of_fit() {
    let folder = tempfile::tempdir().unwrap();
    samples_csv(folder.path());
    let table = run(folder.path(), &["fit", "samples.csv"]);
    assert!(good(&table).contains("chi13"));
    let fitted = good(&run(folder.path(), &["fit", "samples.csv", "--json"]));
    let model: Value = serde_json::from_str(&fitted).unwrap();
    assert_eq!(model["covariance"].as_array().unwrap().len(), 8);
    std::fs::write(folder.path().join("model.json"), &fitted).unwrap();

    let place = ["--lat", "48", "--lon=-6", "--date", "2026-11-15"];
    let asked = ["deviation", "--model", "model.json", "--json"];
    let rows = good(&run(folder.path(), &[&asked[..], &place].concat()));
    let rows: Value = serde_json::from_str(&rows).unwrap();
    let rows = rows["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 24);
    assert!(rows[6]["band95_deg"].as_f64().unwrap() > 0.0);

    let shown = good(&run(folder.path(), &[&asked[..3], &place].concat()));
    assert_eq!(shown.lines().count(), 25, "{shown}");
}

#[test]
fn a_model_file_may_have_parameters_alone() {
    let folder = tempfile::tempdir().unwrap();
    let model = json!({ "parameters_over_lambda": {
        "bx_nt": 2060.0, "chi13": -0.0215, "by_nt": -2930.0, "chi23": 0.0022,
        "chi11_minus_chi22": 0.0352, "chi12": 0.0012, "chi21": 0.0016,
    }});
    std::fs::write(folder.path().join("m.json"), model.to_string()).unwrap();
    let field = ["--h-nt", "24000", "--z-nt=-38000", "--step-deg", "90"];
    let asked = ["deviation", "--model", "m.json", "--json"];
    let output = run(folder.path(), &[&asked[..], &field].concat());
    let rows: Value = serde_json::from_str(&good(&output)).unwrap();
    assert_eq!(rows["rows"].as_array().unwrap().len(), 4);
    assert_eq!(rows["rows"][0]["band95_deg"], json!(null));
}

#[test]
fn analyse_gives_the_servers_analysis_offline() {
    let folder = tempfile::tempdir().unwrap();
    samples_csv(folder.path());
    let book = r#"[{"from":"2026-11-16T00:00:00Z","kind":"adjustment"}]"#;
    std::fs::write(folder.path().join("book.json"), book).unwrap();
    let output = run(
        folder.path(),
        &["analyse", "samples.csv", "--logbook", "book.json"],
    );
    let analysis: Value = serde_json::from_str(&good(&output)).unwrap();
    assert_eq!(analysis["epochs"].as_array().unwrap().len(), 2);
    assert_eq!(analysis["samples"].as_array().unwrap().len(), 300);
    let here = &analysis["sail_next"]["here"];
    assert!(here["band"]["rms_deg"].as_f64().unwrap() > 0.5, "{here}");
}

#[test]
fn an_invalid_logbook_is_refused_by_file_line_and_field() {
    let folder = tempfile::tempdir().unwrap();
    samples_csv(folder.path());
    let good = r#"{"from": "2026-11-16T00:00:00Z", "kind": "adjustment"}"#;
    let turned = "{\"from\": \"2026-11-16T00:00:00Z\", \"kind\": \"berth\",\n  \
                  \"to\": \"2026-11-15T00:00:00Z\"}";
    let cases: [(String, &[&str]); 10] = [
        (
            format!("[{good},\n{turned}\n]"),
            &["book.json:2", "to:", "before"],
        ),
        (
            format!("[{good},\n{}]", good.replace("adjustment", "ufo")),
            &["book.json:2", "kind: ", "ufo"],
        ),
        (
            format!("[{good},\n{}]", good.replace("2026-11-16T", "16 Nov ")),
            &["book.json:2", "from: "],
        ),
        (
            format!("[{good},\n{{\"kind\": \"note\",\n\"from\": 7}}]"),
            &["book.json:3", "from: "],
        ),
        (
            format!("[{good},\n{{\"kind\": \"note\"}}]"),
            &["book.json:2", "from: is missing"],
        ),
        (
            format!("[{good},\n{}]", good.replace('}', ", \"until\": null}")),
            &["book.json:2", "`until`"],
        ),
        (
            "[7]".to_owned(),
            &["book.json:1", "expected a logbook entry"],
        ),
        (
            format!("[{good},\n\n{}]", good.replace("from", "form")),
            &["book.json:3", "from"],
        ),
        (format!("[{good}\n{good}]"), &["book.json:2"]),
        (good.to_owned(), &["book.json:1", "`items`"]),
    ];
    for (book, words) in cases {
        std::fs::write(folder.path().join("book.json"), book).unwrap();
        let arguments = ["analyse", "samples.csv", "--logbook", "book.json"];
        assert_refused(&run(folder.path(), &arguments), words);
    }
}

#[test]
fn a_logbook_from_the_api_is_read_without_withdrawn_entries() {
    let folder = tempfile::tempdir().unwrap();
    samples_csv(folder.path());
    let item = |from: &str, withdrawn_at: Value| {
        json!({
            "id": "0192", "kind": "adjustment", "from": from, "to": null, "cargo": null,
            "hatch": null, "port": "Bilbao", "note": "", "compass_id": null,
            "created_at": from, "created_by": "Ada", "author": "user", "revision": 1,
            "revised_at": null, "revised_by": null, "withdrawn_at": withdrawn_at,
            "withdrawn_by": null, "withdrawal_reason": null,
        })
    };
    let counts = item("2026-11-16T00:00:00Z", Value::Null);
    let withdrawn = item("2026-11-16T12:00:00Z", json!("2026-11-17T00:00:00Z"));
    let page = |next: Value| json!({ "items": [counts, withdrawn], "next": next }).to_string();
    let arguments = ["analyse", "samples.csv", "--logbook", "book.json"];
    let book = folder.path().join("book.json");
    std::fs::write(&book, page(Value::Null)).unwrap();
    let analysis: Value = serde_json::from_str(&good(&run(folder.path(), &arguments))).unwrap();
    assert_eq!(analysis["epochs"].as_array().unwrap().len(), 2);
    std::fs::write(&book, page(json!("more"))).unwrap();
    assert_refused(
        &run(folder.path(), &arguments),
        &["book.json:1", "more pages"],
    );
}

#[test]
fn a_closed_output_pipe_is_not_an_error() {
    let folder = tempfile::tempdir().unwrap();
    samples_csv(folder.path());
    let created = ["admin", "create", "operator", "--name", "Nao"];
    let asked: [&[&str]; 4] = [
        &["analyse", "samples.csv"],
        &["fit", "samples.csv"],
        &["openapi"],
        &created,
    ];
    for arguments in asked {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = command(
            env!("CARGO_BIN_EXE_binnacle-server"),
            folder.path(),
            arguments,
        )
        .stdout(writer)
        .output()
        .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {errors}");
        assert_eq!(errors, "", "{arguments:?}");
    }
}

#[test]
#[allow(clippy::too_many_lines, reason = "a table of cases")]
fn bad_input_is_refused_by_file_line_and_field() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let head = "time,lat,lon,compass_deg,gyro_deg\n2026-11-15T00:00:00Z,48,-6,10,8\n";
    let cases: [(&str, String, &[&str]); 13] = [
        (
            "column.csv",
            head.replace("compass", "needle"),
            &["column.csv:1", "compass_deg"],
        ),
        (
            "twice.csv",
            head.replace("lon", "lat"),
            &["twice.csv:1", "lat"],
        ),
        (
            "nan.csv",
            format!("{head}2026-11-15T00:10:00Z,48,-6,NaN,8"),
            &["nan.csv:3", "compass_deg"],
        ),
        (
            "lat.csv",
            format!("{head}2026-11-15T00:10:00Z,95,-6,10,8"),
            &["lat.csv:3", "lat", "95"],
        ),
        (
            "old.csv",
            format!("{head}1850-01-01T00:00:00Z,48,-6,10,8"),
            &["old.csv:3", "1850"],
        ),
        (
            "time.csv",
            format!("{head}yesterday,48,-6,10,8"),
            &["time.csv:3", "time", "yesterday"],
        ),
        (
            "compass.csv",
            format!("{head}2026-11-15T00:10:00Z,48,-6,400,8"),
            &["compass.csv:3", "compass_deg", "400"],
        ),
        (
            "long.csv",
            format!("{head}2026-11-15T00:10:00Z,48,-6,{},8", "1".repeat(1000)),
            &["long.csv:3", "compass_deg", "1000 bytes"],
        ),
        (
            "spread.csv",
            head.replace("deg\n", "deg,spread_deg\n")
                .replace(",8\n", ",8,wide\n"),
            &["spread.csv:2", "spread_deg", "wide"],
        ),
        (
            "windows.csv",
            head.replace("deg\n", "deg,windows\n")
                .replace(",8\n", ",8,-1\n"),
            &["windows.csv:2", "windows", "-1"],
        ),
        (
            "short.csv",
            format!("{head}2026-11-15T00:10:00Z,48"),
            &["short.csv:3"],
        ),
        ("few.csv", head.to_owned(), &["few.csv", "needed"]),
        (
            "empty.csv",
            String::new(),
            &["empty.csv", "the file is empty"],
        ),
    ];
    for (name, text, words) in cases {
        write(name, &text);
        assert_refused(&run(folder.path(), &["fit", name]), words);
        if name != "few.csv" {
            assert_refused(&run(folder.path(), &["analyse", name]), words);
        }
    }
    let weightless = "variation_deg,h_nt,z_nt,compass_deg,gyro_deg,weight\n-3,24000,38000,10,8,0\n";
    write("weightless.csv", weightless);
    let refused = run(folder.path(), &["fit", "weightless.csv"]);
    assert_refused(&refused, &["weightless.csv", "the weight is 0"]);
    std::fs::write(
        folder.path().join("noise.csv"),
        [0x00, 0xff, 0x80, b'\n', 0xfe],
    )
    .unwrap();
    assert_refused(&run(folder.path(), &["fit", "noise.csv"]), &["noise.csv:1"]);
    assert_refused(&run(folder.path(), &["fit", "none.csv"]), &["none.csv"]);

    write(
        "model.json",
        "{\n\"parameters_over_lambda\": {\"bx_nt\": 1}\n}",
    );
    let asked = [
        "deviation",
        "--model",
        "model.json",
        "--h-nt",
        "20000",
        "--z-nt",
        "0",
    ];
    assert_refused(&run(folder.path(), &asked), &["model.json:2", "chi13"]);
    write("model.json", "{\n\"version\": 2,\n\"parameters\": {}\n}");
    assert_refused(&run(folder.path(), &asked), &["model.json:2", "version 2"]);
    let outside = ["field", "--lat", "95", "--lon", "0", "--date", "2026-01-01"];
    assert_refused(&run(folder.path(), &outside), &["--lat", "95"]);
    let old = ["field", "--lat", "45", "--lon", "0", "--date", "1850-01-01"];
    assert_refused(&run(folder.path(), &old), &["--date", "1850"]);
}

#[test]
fn admin_creates_operators_and_users() {
    let folder = tempfile::tempdir().unwrap();
    let made = good(&run(
        folder.path(),
        &["admin", "create", "operator", "--name", "Nao"],
    ));
    let made: Value = serde_json::from_str(&made).unwrap();
    let operator = made["operator_id"].as_str().unwrap();
    let user = [
        "admin",
        "create",
        "user",
        "--operator",
        operator,
        "--email",
        "A@b.example",
    ];
    let more = ["--name", "Ada", "--role", "viewer"];
    let user = [&user[..], &more].concat();
    let created: Value = serde_json::from_str(&good(&run(folder.path(), &user))).unwrap();
    assert!(created["password"].as_str().unwrap().len() >= 16);
    assert_refused(
        &run(folder.path(), &user),
        &["--email", "already has an account"],
    );
    let nobody = user.iter().map(|word| match *word {
        word if word == operator => "00000000-0000-0000-0000-000000000000",
        "A@b.example" => "c@d.example",
        word => word,
    });
    let nobody: Vec<&str> = nobody.collect();
    assert_refused(
        &run(folder.path(), &nobody),
        &["--operator", "does not exist"],
    );
}

#[test]
fn an_unsupported_database_url_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), &["migrate", "--database-url", "mysql://x/y"]);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        !output.status.success() && errors.contains("postgres:"),
        "{errors}"
    );
}
