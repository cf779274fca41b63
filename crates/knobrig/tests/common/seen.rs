//! What became of random sequences.

/// What became of sequences.
#[derive(Debug, Default, Clone, Copy)]
pub struct Seen {
    pub samples: u64,
    pub with_torque: u64,
    pub renderings: u64,
    pub refused_models: u64,
    pub forced: u64,
    pub watchdog: u64,
    pub faults: u64,
    pub emptied: u64,
    pub most_torque_share: f64,
    pub most_energy_share: f64,
    pub most_of_places: f64,
    pub fastest: f64,
}

impl Seen {
    /// Brings in what became of one more.
    pub fn add(&mut self, one: &Self) {
        self.samples += one.samples;
        self.with_torque += one.with_torque;
        self.renderings += one.renderings;
        self.refused_models += one.refused_models;
        self.forced += one.forced;
        self.watchdog += one.watchdog;
        self.faults += one.faults;
        self.emptied += one.emptied;
        self.most_torque_share = self.most_torque_share.max(one.most_torque_share);
        self.most_energy_share = self.most_energy_share.max(one.most_energy_share);
        self.most_of_places = self.most_of_places.max(one.most_of_places);
        self.fastest = self.fastest.max(one.fastest);
    }

    /// In one line of JSON.
    pub fn document(&self, seed: u64, sequences: u64, exceeded: usize) -> String {
        let figures = [
            ("samples", self.samples as f64),
            ("samples_with_torque", self.with_torque as f64),
            ("renderings", self.renderings as f64),
            ("models_refused", self.refused_models as f64),
            ("models_forced", self.forced as f64),
            ("watchdog_faults", self.watchdog as f64),
            ("other_faults", self.faults as f64),
            ("tanks_emptied", self.emptied as f64),
            ("most_torque_of_limit", (1e4 * self.most_torque_share).round() / 1e4),
            ("most_energy_of_limit", (1e4 * self.most_energy_share).round() / 1e4),
            ("most_energy_of_places", (1e4 * self.most_of_places).round() / 1e4),
            ("fastest_rad_s", (1e4 * self.fastest).round() / 1e4),
        ];
        let figures = figures.map(|(name, value)| format!("\"{name}\": {value}")).join(", ");
        format!(
            "{{\"seed\": {seed}, \"sequences\": {sequences}, \"limits_exceeded\": {exceeded}, {figures}}}"
        )
    }
}
