//! Priors from a vessel's fleet: their publication, their choice, and what keeps them honest.

use crate::analysis::{A_WHILE_S, DAY};
use binnacle_analysis::estimate::POPULATION_SD;
use binnacle_compass::model::Parameters;
use binnacle_compass::result::{Analysis, ESTIMATOR, Epoch};
use binnacle_fleet::analysis::{AnalysisResult, Covered, Findings, store};
use binnacle_fleet::analysis_queue;
use binnacle_platform::ids::{CompassId, VesselId};
use binnacle_platform::time::Time;
use binnacle_priors::find_or_choose;
use binnacle_server_testing::{
    DAY_S, Person, Ship, TestServer, on_both, passage, patch, true_model,
};
use serde_json::{Value, json};

on_both!(
    a_new_ship_begins_with_her_sisters_and_has_a_narrower_band,
    a_class_is_published_once_in_thirty_days,
    a_ship_keeps_her_prior_until_another_estimator_derives_her,
    a_class_that_is_too_small_is_named_and_the_fleet_used,
    another_operators_ships_never_count,
    compasses_of_another_role_do_not_count,
    a_ship_analysed_without_a_prior_keeps_the_populations,
    two_servers_publish_one_edition,
    a_ship_that_shows_no_more_than_her_sisters_did_is_no_evidence,
    a_sister_class_is_trimmed_and_bounded,
);

const MONTH_S: f64 = 30.0 * DAY_S;
const CLASS: &str = "Handy";

/// Creates a vessel of the class, and returns her id and that of her compass.
async fn vessel(person: &Person, class: &str) -> (VesselId, CompassId) {
    let body = json!({ "name": "Nao", "sister_class": class });
    let vessel = person.post("/vessels", &body).await.good();
    assert_eq!(vessel["sister_class"], class);
    let id = serde_json::from_value(vessel["id"].clone()).unwrap();
    let compass = vessel["compasses"][0]["id"].clone();
    (id, serde_json::from_value(compass).unwrap())
}

/// Enters sister ships with analyses that show their magnetism well in all waters.
async fn sisters(server: &TestServer, person: &Person, class: &str, count: usize) {
    for nth in 0..count {
        let (id, compass) = vessel(person, class).await;
        analysed(server, id, compass, nth).await;
    }
}

/// Stores an analysis whose first epoch shows a ship a little unlike the usual one.
async fn analysed(server: &TestServer, vessel_id: VesselId, compass_id: CompassId, nth: usize) {
    let mut model = true_model();
    let mut ratios = model.parameters_over_lambda.to_array();
    let mut covariance = [[0.0; 8]; 8];
    covariance[7][7] = 0.1;
    for (j, ratio) in ratios.iter_mut().enumerate() {
        let away = ((5 * nth + 3 * j) % 7) as f64 / 3.0 - 1.0;
        *ratio += 0.1 * away * POPULATION_SD[j];
        covariance[j][j] = (0.1 * POPULATION_SD[j]).powi(2);
    }
    model.parameters_over_lambda = Parameters::from_array(ratios);
    model.covariance = Some(covariance);
    let coverage = binnacle_compass::coverage::coverage([]);
    let analysis = Analysis {
        estimator: ESTIMATOR.to_owned(),
        epochs: vec![Epoch {
            from: None,
            to: None,
            begun_by: None,
            begun_by_change: None,
            resumes: None,
            data_from: None,
            data_until: None,
            left_out_laden: 0,
            left_out_alongside: 0,
            references: None,
            noise: None,
            model: Some(model),
            refusal: None,
        }],
        changes: Vec::new(),
        notices: Vec::new(),
        samples: Vec::new(),
        coverage: coverage.clone(),
        predictions: None,
        data_from: None,
        data_until: None,
        last_place: None,
    };
    let result = AnalysisResult {
        vessel_id,
        compass_id,
        input_hash: String::new(),
        analysis,
        covered: Covered {
            coverage,
            sail_next: None,
            references: None,
            predictions: None,
        },
        findings: Findings::default(),
        segments: Vec::new(),
    };
    let mut tx = server.app.db.begin().await.unwrap();
    let now = Time(server.app.clock.now());
    store::save(&mut tx, &result, now).await.unwrap();
    tx.commit().await.unwrap();
}

/// Enters a ship of the class whose agent has sent a short passage, and analyses her.
async fn newcomer(server: &TestServer, person: &Person, class: &str, samples: usize) -> Ship {
    let ship = server.ship(person, "Nova").await;
    let amendment = json!({ "sister_class": class });
    patch(person, &ship.path(""), &amendment).await.good();
    sail(server, &ship, 1, samples).await;
    ship
}

/// Sends a passage as a batch, and analyses it.
async fn sail(server: &TestServer, ship: &Ship, seq: u64, samples: usize) {
    ship.put(seq, &passage(DAY, samples)).await.good();
    server.advance(A_WHILE_S);
    assert_eq!(server.work().await.len(), 1);
}

/// Signs a person in after a time that ends sessions.
async fn signed_in_again(server: &TestServer, person: &Person) -> Person {
    Person::sign_in(server, person.operator, &person.email).await
}

async fn prior(person: &Person, ship: &Ship) -> Value {
    person.get(&ship.path("/prior")).await.good()
}

async fn publications(person: &Person) -> Vec<Value> {
    let list = person.get("/fleet-priors").await.good();
    list["items"].as_array().unwrap().clone()
}

/// Returns the mean width of the band far to the south, degrees.
async fn band_far_away(person: &Person, ship: &Ship) -> f64 {
    let path = ship.path("/deviation?step_deg=30&lat=-20&lon=-6");
    let table = person.get(&path).await.good();
    let rows = table["rows"].as_array().unwrap();
    let sum: f64 = rows
        .iter()
        .filter_map(|row| row["band95_deg"].as_f64())
        .sum();
    sum / rows.len() as f64
}

async fn a_new_ship_begins_with_her_sisters_and_has_a_narrower_band(server: TestServer) {
    let (ada, ben) = (server.admin("ada").await, server.admin("ben").await);
    sisters(&server, &ada, CLASS, 10).await;
    let with = newcomer(&server, &ada, CLASS, 40).await;
    let alone = newcomer(&server, &ben, CLASS, 40).await;
    let prior = prior(&ada, &with).await;
    assert_eq!(prior["estimator"], ESTIMATOR);
    assert_eq!(prior["refused"], json!([]));
    let class = json!({ "kind": "sisters", "name": CLASS });
    let published = &publications(&ada).await[0];
    assert_eq!(
        prior["basis"],
        json!({
            "method": 1, "published_at": published["published_at"], "class": class, "ships": 10,
        })
    );
    assert_eq!(
        (&published["class"], &published["role"]),
        (&class, &json!("standard"))
    );

    let (narrow, wide) = (
        band_far_away(&ada, &with).await,
        band_far_away(&ben, &alone).await,
    );
    assert!(narrow < 0.9 * wide, "{narrow} {wide}");
    // The same samples with another prior are another input.
    let hash = async |person: &Person, ship: &Ship| {
        person.get(&ship.path("/model")).await.good()["input_hash"].clone()
    };
    assert_ne!(hash(&ada, &with).await, hash(&ben, &alone).await);
    let as_with = newcomer(&server, &ada, CLASS, 40).await;
    assert_eq!(hash(&ada, &with).await, hash(&ada, &as_with).await);
    server.finish().await;
}

async fn a_class_is_published_once_in_thirty_days(server: TestServer) {
    let ada = server.admin("ada").await;
    sisters(&server, &ada, CLASS, 3).await;
    let first = newcomer(&server, &ada, CLASS, 3).await;
    sisters(&server, &ada, CLASS, 1).await;
    server.advance(MONTH_S - DAY_S);
    let ada = signed_in_again(&server, &ada).await;
    let second = newcomer(&server, &ada, CLASS, 3).await;
    let (first, second) = (prior(&ada, &first).await, prior(&ada, &second).await);
    assert_eq!(first["basis"], second["basis"]);
    assert_eq!(publications(&ada).await.len(), 1);
    server.advance(DAY_S);
    let ada = signed_in_again(&server, &ada).await;
    let third = newcomer(&server, &ada, CLASS, 3).await;
    assert_eq!(prior(&ada, &third).await["basis"]["ships"], 4);
    let ships: Vec<Value> = publications(&ada)
        .await
        .iter()
        .map(|p| p["ships"].clone())
        .collect();
    assert_eq!(ships, [4, 3]);
    let page = ada.get("/fleet-priors?limit=1").await.good();
    let next = format!("/fleet-priors?after={}", page["next"].as_str().unwrap());
    assert_eq!(ada.get(&next).await.good()["items"][0]["ships"], 3);
    server.finish().await;
}

async fn a_ship_keeps_her_prior_until_another_estimator_derives_her(server: TestServer) {
    let ada = server.admin("ada").await;
    sisters(&server, &ada, CLASS, 2).await;
    let nova = newcomer(&server, &ada, CLASS, 3).await;
    let chosen = prior(&ada, &nova).await;
    sisters(&server, &ada, CLASS, 3).await;
    server.advance(2.0 * MONTH_S);
    let ada = signed_in_again(&server, &ada).await;
    sail(&server, &nova, 2, 40).await;
    assert_eq!(prior(&ada, &nova).await, chosen);

    server
        .run_sql("UPDATE analyses SET estimator = 'older'")
        .await;
    server
        .run_sql("UPDATE vessel_priors SET estimator = 'older'")
        .await;
    server
        .run_sql("UPDATE fleet_priors SET estimator = 'older'")
        .await;
    let mut tx = server.app.db.begin().await.unwrap();
    let (id, now) = (nova.id.parse().unwrap(), Time(server.app.clock.now()));
    analysis_queue::enqueue(&mut tx, VesselId(id), now, 0.0)
        .await
        .unwrap();
    tx.commit().await.unwrap();
    // Before that analysis the prior of the last one is shown.
    assert_eq!(prior(&ada, &nova).await["basis"], chosen["basis"]);
    server.work().await;
    let anew = prior(&ada, &nova).await;
    assert_eq!(anew["estimator"], ESTIMATOR);
    assert_eq!(anew["basis"]["ships"], 5);
    server.finish().await;
}

async fn a_class_that_is_too_small_is_named_and_the_fleet_used(server: TestServer) {
    let ada = server.admin("ada").await;
    sisters(&server, &ada, CLASS, 1).await;
    let alone = newcomer(&server, &ada, CLASS, 3).await;
    let too_small = |class: &Value| json!({ "class": class, "ships": 1, "needed": 2 });
    let class = json!({ "kind": "sisters", "name": CLASS });
    let refused = [too_small(&class), too_small(&json!({ "kind": "operator" }))];
    let found = prior(&ada, &alone).await;
    assert_eq!(
        (&found["basis"], &found["refused"]),
        (&json!(null), &json!(refused))
    );
    assert!(publications(&ada).await.is_empty());
    // Nothing is lost: the model comes as ever.
    sail(&server, &alone, 2, 300).await;
    ada.get(&alone.path("/model")).await.good();

    sisters(&server, &ada, "Panamax", 2).await;
    let next = newcomer(&server, &ada, CLASS, 3).await;
    let found = prior(&ada, &next).await;
    // The ship that came alone is a sister by now.
    assert_eq!(found["basis"]["class"], class);
    let third = newcomer(&server, &ada, "Cape", 3).await;
    let found = prior(&ada, &third).await;
    assert_eq!(found["basis"]["class"], json!({ "kind": "operator" }));
    assert_eq!(found["basis"]["ships"], 4);
    assert_eq!(found["refused"][0]["class"]["name"], "Cape");
    assert_eq!(found["refused"][0]["ships"], 0);
    server.finish().await;
}

async fn another_operators_ships_never_count(server: TestServer) {
    let (ada, ben) = (server.admin("ada").await, server.admin("ben").await);
    sisters(&server, &ada, CLASS, 3).await;
    newcomer(&server, &ada, CLASS, 3).await;
    let of_ben = newcomer(&server, &ben, CLASS, 3).await;
    let found = prior(&ben, &of_ben).await;
    assert_eq!(found["basis"], json!(null));
    let refused = found["refused"].as_array().unwrap();
    assert_eq!(refused.len(), 2);
    assert!(
        refused.iter().all(|class| class["ships"] == 0),
        "{refused:?}"
    );
    assert!(publications(&ben).await.is_empty());
    assert_eq!(ada.get(&of_ben.path("/prior")).await.problem(), "not-found");
    server.finish().await;
}

async fn compasses_of_another_role_do_not_count(server: TestServer) {
    let ada = server.admin("ada").await;
    for nth in 0..3 {
        let (id, compass) = vessel(&ada, CLASS).await;
        analysed(&server, id, compass, nth).await;
        let path = format!("/vessels/{id}/compasses/{compass}");
        patch(&ada, &path, &json!({ "role": "steering" }))
            .await
            .good();
    }
    let nova = newcomer(&server, &ada, CLASS, 3).await;
    assert_eq!(prior(&ada, &nova).await["basis"], json!(null));
    server.finish().await;
}

async fn a_ship_analysed_without_a_prior_keeps_the_populations(server: TestServer) {
    let ada = server.admin("ada").await;
    sisters(&server, &ada, CLASS, 3).await;
    let nao = newcomer(&server, &ada, CLASS, 3).await;
    server.run_sql("DELETE FROM vessel_priors").await;
    assert_eq!(prior(&ada, &nao).await["chosen_at"], json!(null));
    sail(&server, &nao, 2, 40).await;
    let found = prior(&ada, &nao).await;
    assert_eq!(
        (&found["basis"], &found["refused"]),
        (&json!(null), &json!([]))
    );
    server.finish().await;
}

async fn two_servers_publish_one_edition(server: TestServer) {
    let ada = server.admin("ada").await;
    sisters(&server, &ada, CLASS, 3).await;
    let other = server.second_server().await;
    let (one, two) = (vessel(&ada, CLASS).await, vessel(&ada, CLASS).await);
    let now = Time(server.app.clock.now());
    let (first, second) = tokio::join!(
        find_or_choose(&server.app.db, one.0, one.1, now),
        find_or_choose(&other.db, two.0, two.1, now),
    );
    assert_eq!(first.unwrap().prior, second.unwrap().prior);
    assert_eq!(publications(&ada).await.len(), 1);
    other.db.close().await;
    server.finish().await;
}

async fn a_ship_that_shows_no_more_than_her_sisters_did_is_no_evidence(server: TestServer) {
    let ada = server.admin("ada").await;
    sisters(&server, &ada, CLASS, 10).await;
    // Her few headings alone would not give the narrow model that she has.
    let nova = newcomer(&server, &ada, CLASS, 40).await;
    let model = ada.get(&nova.path("/model")).await.good();
    let chi13_variance = model["model"]["covariance"][1][1].as_f64().unwrap();
    assert!(chi13_variance < 0.5 * POPULATION_SD[1].powi(2));
    let other_class = newcomer(&server, &ada, "Cape", 3).await;
    let found = prior(&ada, &other_class).await;
    assert_eq!(found["basis"]["class"], json!({ "kind": "operator" }));
    assert_eq!(found["basis"]["ships"], 10);
    server.finish().await;
}

async fn a_sister_class_is_trimmed_and_bounded(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = server.ship(&ada, "Nao").await;
    let set =
        async |class: Value| patch(&ada, &nao.path(""), &json!({ "sister_class": class })).await;
    assert_eq!(
        set(json!(" Handy 38 ")).await.good()["sister_class"],
        "Handy 38"
    );
    assert_eq!(set(json!("x".repeat(201))).await.problem(), "invalid");
    let named = ada.get(&nao.path("")).await.good();
    assert_eq!(named["sister_class"], "Handy 38");
    assert_eq!(set(json!(null)).await.good()["sister_class"], json!(null));
    server.finish().await;
}
