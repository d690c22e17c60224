//! The report as others see it: JSON against its schema, headlines, the Markdown table.

use lf_report::{BASELINE_METHOD, EyeError, Frames, Machine, MethodResult, Plot, Report, ReportError, Table, Timing};
use serde_json::Value;

fn frames(scene: &str, reflector: &str, size: u32) -> Frames {
    Frames { scene: scene.to_owned(), reflector: reflector.to_owned(), size: [size; 2] }
}

fn result(reflector: &str, method: &str, device: &str, psnr_db: &[f64], ms: f64) -> MethodResult {
    let eye = |(eye, &psnr_db): (usize, &f64)| EyeError {
        eye,
        psnr_db,
        mse: 3.5,
        rel_mse: 0.01,
        flip: 0.05,
        ssim: 0.9,
        share_over_tenth: 0.02,
        max_abs: 9,
        pixels: 1000,
    };
    MethodResult {
        frames: frames("museum", reflector, 512),
        method: method.to_owned(),
        parameters: "16×16".to_owned(),
        device: device.to_owned(),
        eyes: psnr_db.iter().enumerate().map(eye).collect(),
        timing: Timing::from_seconds(vec![ms * 1e-3]).unwrap(),
        bytes_on_device: 1 << 20,
        bytes_on_disk: (!psnr_db.is_empty()).then_some(2048),
        preparation_s: 2.5,
        rays: None,
    }
}

fn report(results: Vec<MethodResult>) -> Report {
    Report {
        title: "Title".to_owned(),
        generator: "program 1.0".to_owned(),
        machine: Machine::detect(Some("Adapter".to_owned())),
        reproduce: "program run".to_owned(),
        facts: vec![("Size".to_owned(), "1 m".to_owned())],
        results,
        tables: vec![Table {
            title: "Left out".to_owned(),
            caption: String::new(),
            columns: vec!["what".to_owned()],
            rows: vec![vec!["slots".to_owned()]],
        }],
        notes: vec!["Note.".to_owned()],
    }
}

/// Holds `value` against the part of JSON Schema that `report.schema.json` uses.
fn check(value: &Value, schema: &Value, path: &str) {
    assert!(schema["description"].as_str().is_some_and(|d| !d.is_empty()), "{path}: not described");
    let named: Vec<&str> = match &schema["type"] {
        Value::Array(names) => names.iter().filter_map(Value::as_str).collect(),
        name => name.as_str().into_iter().collect(),
    };
    let is = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        other => panic!("{path}: the schema has an unknown type {other}"),
    };
    assert!(named.iter().any(|name| is(name)), "{path}: {value} is not one of {named:?}");
    assert!(schema.get("const").is_none_or(|expected| expected == value), "{path}: {value}");
    assert!(schema["minimum"].as_f64().is_none_or(|low| value.as_f64().is_none_or(|v| v >= low)), "{path}: {value}");
    assert!(schema["maximum"].as_f64().is_none_or(|high| value.as_f64().is_none_or(|v| v <= high)), "{path}: {value}");
    if let Some(object) = value.as_object() {
        check_properties(object, schema, path);
    }
    for (i, item) in value.as_array().into_iter().flatten().enumerate() {
        check(item, &schema["items"], &format!("{path}[{i}]"));
    }
}

/// The object has exactly the schema's properties, and the schema requires all of them.
fn check_properties(object: &serde_json::Map<String, Value>, schema: &Value, path: &str) {
    let properties = schema["properties"].as_object().unwrap();
    let names = |keys: &mut dyn Iterator<Item = &str>| {
        let mut names: Vec<String> = keys.map(str::to_owned).collect();
        names.sort_unstable();
        names
    };
    let expected = names(&mut properties.keys().map(String::as_str));
    assert_eq!(names(&mut object.keys().map(String::as_str)), expected, "{path}");
    let required = schema["required"].as_array().unwrap();
    assert_eq!(names(&mut required.iter().filter_map(Value::as_str)), expected, "{path}: required");
    assert_eq!(schema["additionalProperties"], Value::Bool(false), "{path}");
    for (name, property) in properties {
        assert!(name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_'), "{path}.{name}");
        check(&object[name], property, &format!("{path}.{name}"));
    }
}

#[test]
fn json_has_exactly_the_properties_of_the_schema() {
    let schema: Value = serde_json::from_str(include_str!("../report.schema.json")).unwrap();
    let mut with_nulls = report(vec![
        result("teapot", "slabs", "CPU", &[30.0, f64::INFINITY], 10.0),
        result("teapot", "ray tracing", "CPU", &[], 300.0),
    ]);
    with_nulls.machine.adapter = None;
    for report in [with_nulls, report(vec![result("teapot", BASELINE_METHOD, "GPU", &[20.0], 1.0)])] {
        let json = report.to_json().unwrap();
        check(&serde_json::from_str(&json).unwrap(), &schema, "report");
        assert!(json.starts_with("{\n  \"schema\": \"lfslab-report/3\""), "{json}");
    }
}

#[test]
fn infinite_psnr_is_null_and_so_is_its_mean() {
    let report = report(vec![result("teapot", "slabs", "CPU", &[30.0, f64::INFINITY], 10.0)]);
    let json: Value = serde_json::from_str(&report.to_json().unwrap()).unwrap();
    let result = &json["results"][0];
    assert_eq!(result["eyes"][0]["psnr_db"], 30.0);
    assert_eq!((&result["eyes"][1]["psnr_db"], &result["mean_psnr_db"]), (&Value::Null, &Value::Null));
    assert_eq!(result["timing"]["median_ms"], 10.0);
}

#[test]
fn numbers_that_json_cannot_hold_are_refused() {
    let mut report = report(vec![result("teapot", "slabs", "CPU", &[30.0], 10.0)]);
    report.results[0].eyes[0].mse = f64::NAN;
    let plot = report.plot(&report.results[0].frames, Plot::Time).map(Option::unwrap_or_default);
    for outcome in [report.to_json(), report.to_csv(), report.to_html(&[]), plot] {
        let Err(ReportError::InvalidArgument { what, .. }) = outcome else { panic!("{outcome:?}") };
        assert_eq!(what, "mean squared error of eye 0 of slabs on teapot");
    }
}

#[test]
fn headlines_compare_on_the_same_reflector_and_device() {
    let mut report = report(vec![
        result("teapot", "ray tracing", "CPU", &[], 345.0),
        result("teapot", BASELINE_METHOD, "CPU", &[20.0, 22.0], 4.5),
        result("teapot", "slabs", "CPU", &[30.0, 31.0], 12.25),
        result("sphere", "slabs", "CPU", &[30.0], 12.0),
    ]);
    let expected = "teapot: 9.5 dB more with slabs than with environment map \
                    (30.5 against 21.0 dB PSNR, mean of 2 eyes), at 12.2 ms a frame against 4.50 ms; \
                    the reference takes 345 ms.";
    assert_eq!(report.headlines(), [expected]);
    report.results.push(result("teapot", BASELINE_METHOD, "GPU", &[25.0], 0.5));
    report.results.push(result("teapot", "slabs", "GPU", &[24.0], 1.5));
    let headlines = report.headlines();
    assert_eq!(headlines.len(), 2);
    assert!(headlines[0].starts_with("teapot on CPU: 9.5 dB more"), "{headlines:?}");
    assert!(headlines[1].starts_with("teapot on GPU: 1.0 dB less with slabs"), "{headlines:?}");
    assert!(headlines[1].contains("one eye"), "{headlines:?}");
}

#[test]
fn frames_are_named_by_what_they_do_not_share() {
    let at = |frames: Frames| MethodResult { frames, ..result("teapot", "slabs", "CPU", &[30.0], 10.0) };
    let mut report = report(vec![at(frames("museum", "teapot", 512)), at(frames("museum", "sphere", 512))]);
    let labels = |report: &Report| -> Vec<String> { report.frames().into_iter().map(|f| report.label(f)).collect() };
    assert_eq!(labels(&report), ["teapot", "sphere"]);
    report.results.push(at(frames("corridor", "sphere", 256)));
    assert_eq!(
        labels(&report),
        ["teapot in museum, 512×512", "sphere in museum, 512×512", "sphere in corridor, 256×256"]
    );
    assert_eq!(report.results_of(&frames("museum", "sphere", 512)).len(), 1);
    assert_eq!(report.to_markdown().matches("| method | parameters |").count(), 3);
    // Nobody counted rays.
    assert!(report.plot(&report.results[0].frames, Plot::Capture).unwrap().is_none());
    assert!(report.plot(&report.results[0].frames, Plot::Disk).unwrap().is_some());
}
