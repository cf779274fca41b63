/**
 * What the server and the reports tell. Made by `python3 dev.py page` of pages*.py in python/knobcam/base.
 */

/** A number with its unit, and as text has it. @typedef {{value: number, unit: string, text: string}} Quantity */

/**
 * A stretch of an axis, where the knob moves forward (1), backward (-1) or both (0); `words` for it.
 *
 * `ends` are low and high as they are written: as near to zero as nothing beside the other is zero.
 * @typedef {{axis: "position" | "velocity" | "acceleration" | "load" | "history" | "time" | "frequency",
 *   low: number, high: number, ends: [number, number], unit: string, direction: number, words: string}} Stretch
 */

/** The axis that something lies along. @typedef {{along: string}} OfAxis */

/** An effect, by its id. @typedef {{effect: string}} OfEffect */

/** A parameter, by its name. @typedef {{param: string}} OfParam */

/** A column of a capture, by its name. @typedef {{column: string}} OfColumn */

/** Words with more to know behind them. @typedef {{words: string, topic: "error" | "findings"}} Topic */

/**
 * What to do, in words of the command line, and the `way` of it.
 * @typedef {{advice: string, way: "" | "columns" | "unit" | "minus" | "unwrap" | "parts" | "drive" | "command"}}
 *   Advice
 */

/**
 * Parameters of a law that mean the same, and what that is.
 * @typedef {{names: string[], meaning: string, unit: string}} Letters
 */

/**
 * What captures cannot tell; `sharpen` is the parameter, if one, that a motion of its own tells.
 * @typedef {{said: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   sharpen: string | null}} Limitation
 */

/**
 * A parameter on which captures disagree, and by how much.
 * @typedef {{param: string,
 *   said: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[]}} Disagreement
 */

/**
 * What no effect explains over a variable, as a factor of `times`, and half the width of its 95 % band.
 *
 * Null where the motion hardly went. `laws`: each law in their order, null for one that is not drawn.
 * @typedef {{over: string, times: string, x: number[], value: (number | null)[], band: (number | null)[],
 *   laws: ((number | null)[] | null)[]}} Curve
 */

/**
 * What no effect explains over two variables, as a factor of `times`: a row for each `y` of the second.
 *
 * Null where the motion did not go. `laws`: each law in their order, null for one of fewer variables.
 * @typedef {{over: [string, string], times: string, x: number[], y: number[], value: ((number | null)[])[],
 *   laws: (((number | null)[])[] | null)[]}} Surface
 */

/** A limit, and how wide it would have to be. @typedef {{limit: string, to: number}} Enough */

/**
 * Two rivals: D that a motion promises, that of the best standard one, and what came (null: not yet).
 * @typedef
 *   {{names: [(string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[], (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[]],
 *   d: number, standard_d: number, wrong_choice: number, came: number | null}} Pair
 */

/**
 * What a hand has to do, in words; `beats` a minute, 0: none; why it `cannot`, empty where it can.
 * @typedef {{words: string, seconds: number, beats: number, cannot: string}} HandStep
 */

/**
 * A motion that tells rivals apart from D = `told` on; `verdict` is what its recording `capture` told.
 *
 * Of one rival alone it makes a parameter known better. `headline` is what it `promises` and how it moves,
 * `source` what it can be recorded from at once, in words. Rivals that it does not tell apart are with
 * `change`, if that is known.
 * @typedef {{id: string,
 *   rivals: ((string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[])[],
 *   promises: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   headline: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   separable: boolean, seconds: number, limits: Record<string, number>, change: Enough | null, pairs: Pair[],
 *   told: number, by_hand: boolean, steps: HandStep[], source: string | null, capture: string | null,
 *   verdict: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[] | null}}
 *   Experiment
 */

/**
 * What the quality check found in a capture, and whether a person has `overruled` it, by its `key`.
 *
 * `stands` is why nobody can, `seen` whether it names samples; a "note" changes nothing.
 * @typedef {{key: string,
 *   said: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   advice: Advice | null, severity: "note" | "masked" | "mended" | "warning", overruled: boolean, stands: string,
 *   seen: boolean}} Finding
 */

/**
 * A capture that is open; `hides`: whether something in it is to be found.
 * @typedef {{id: string, name: string, samples: number, rate_hz: number, coordinate: "rotary" | "linear",
 *   findings: Finding[], hides: boolean}} CaptureInfo
 */

/**
 * A fit on the way of a branch; `anew` of a model of its own, not that of the step before.
 *
 * `along` is what came in by itself beside what was `added`.
 * `noise_floor`, where it is known, is read from what the model leaves too: it may fall with that.
 * @typedef {{node: string, anew: boolean, added: string | null, along: string[], dropped: string[], rmse: number,
 *   rmse_heldout: number | null, noise_floor: number | null, captures: string[]}} Step
 */

/**
 * A branch, and at which of its steps it is.
 * @typedef {{id: string, name: string, at: number, steps: Step[]}} Branch
 */

/**
 * A step to what a model brought along to other captures, fitted to these.
 * @typedef {{added: string | null, rmse: number, rmse_heldout: number | null, noise_floor: number | null}} Carried
 */

/**
 * A step of the error ladder: what came in, and the error with it.
 * @typedef {{label: string, rmse: number, rmse_heldout: number | null}} LadderStep
 */

/**
 * A parameter; `doubt` is what is doubtful about its fitted value, `dragged` whether a hand moved it.
 * @typedef {{name: string, value: number, ci95: [number, number] | null, unit: string, role: string,
 *   fitted: number, dragged: boolean, lower: number | null, upper: number | null, meaning: string,
 *   doubt: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[] | null}}
 *   Param
 */

/**
 * Two fitted parameters that the captures do not tell apart well, and their correlation.
 * @typedef {{names: string[], correlation: number}} Together
 */

/**
 * An effect of the catalogue, in words; `letters` are those of its law.
 * @typedef {{effect: string, place: string, law: string, source: string, shows: string, confused: string[],
 *   title: string, name: string, about: string, causes: string[], remedies: string[], latex: string,
 *   letters: Letters[], over: string, section: string | null, friction: boolean}} Effect
 */

/**
 * How far a parameter went when an effect came in.
 * @typedef {{by_se: number, by_percent: number | null, by: number}} Movement
 */

/**
 * An effect that could be missing, with what speaks for it and against it; `said` is `word` in words.
 *
 * `unsettled` says which of its values are not determined, where that is most of them.
 * @typedef {{effect: string, place: string, law: string, source: string, shows: string, confused: string[],
 *   title: string, name: string, about: string, causes: string[], remedies: string[], latex: string,
 *   letters: Letters[], over: string, section: string | null, friction: boolean,
 *   word: "missing" | "part" | "alike" | "less" | "implausible" | "too_little" | "unpaid" | "chance" | "untold",
 *   said: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   could_be: boolean, beyond_chance: boolean, p_value: number, error_fall: number, rmse_heldout: number | null,
 *   moved: Record<string, Movement>, equivalent: string[],
 *   implausible: ((string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[])[],
 *   unsettled: string, note: string}} Candidate
 */

/**
 * What no effect explains: along which axis, which share of the error, of what shape.
 * @typedef {{axis: string, share: number,
 *   hint: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[]}} Unexplained
 */

/**
 * What was weighed, best first, once it is `ready`; `left_out` is what could not be, and why.
 * @typedef {{ready: boolean, rows: Candidate[], unexplained: Unexplained | null,
 *   left_out: Record<string, string>}} Candidates
 */

/**
 * What would explain what no effect does, in words; `law` and its values as one types them to `start`.
 *
 * `variables` are what it is of, `doubt` which values nobody knows, `fall` of the error it was sought in.
 * @typedef {{label: string, rmse: number, rmse_heldout: number | null, law: string, fall: number,
 *   variables: string[], words: string[], doubt: string, start: string}} Law
 */

/**
 * What is being done, for how many `seconds`; `done` from 0 to 1, null while nobody can tell.
 *
 * `takes_s`: from how many seconds to how many it usually takes, where that is known. One that `stops` can
 * be ended with what it has found by then.
 * @typedef {{id: string,
 *   what: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   done: number | null, takes_s: [number, number] | null, seconds: number, stops: boolean, recording: boolean}}
 *   Job
 */

/**
 * The mean residual in bins of an axis, and the half-width of the 95 % band that chance gives it.
 *
 * Along frequency `mean` is the RMS per bin, `band` what chance stays below.
 * `direction` is whose motion a bin holds: 1 forward, -1 backward, 0 both.
 * @typedef {{axis: "position" | "velocity" | "acceleration" | "load" | "history" | "time" | "frequency",
 *   low: number[], high: number[], direction: number[], mean: number[], band: (number | null)[]}} Split
 */

/** The answer of `GET /api/splits`: the error of a fit along every axis. @typedef {{splits: Split[]}} Splits */

/**
 * What a session has; before the first capture there is no node, `proposed` is null until it is asked.
 *
 * Of each of `untold` one is in the model, not known which; what is `needless` does what came in since does.
 * `added` is not named in what is said: what is `concluded`, if anything, be it by a search for everything
 * that ended here (`searched`), and the `verdict`; only a search weighs `sets`. What to `record` shows more
 * of what has no name, a motion `shown_along` its axis, in `limits`; `below_hz` is the edge of the filter.
 * @typedef {{schema: string, revision: number, captures: CaptureInfo[], branches: Branch[], active: string[],
 *   branch: string | null, node: string | null, noise_floor: number | null, unit: string, peak: number,
 *   below_hz: number | null, params: Param[], together: Together[], rmse: number | null,
 *   rmse_heldout: number | null, added: string[],
 *   concluded: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   sets: boolean, searched: boolean,
 *   verdict: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   record: string | null, carried: Carried[], ladder: LadderStep[], candidates: Candidates, warnings: string[],
 *   limitations: Limitation[], disagreements: Disagreement[], titles: Record<string, string>, absent: Effect[],
 *   untold: string[][], proposed: Law[] | null,
 *   proposed_said: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   curve: Curve | null, surface: Surface | null, limits: Record<string, number> | null,
 *   experiment: Experiment | null, needless: string[], shown_along: string | null}} Session
 */

/**
 * What is drawn: along which axes, isolated parts, the 95 % band, residuals held at one scale.
 * @typedef {{axes: ("position" | "velocity" | "acceleration" | "load" | "history" | "time" | "frequency")[],
 *   isolated: boolean, band: boolean, held: boolean}} Seen
 */

/**
 * A rectangle in one of the plots, by its number, in units of the data.
 * @typedef {{plot: number, x: [number, number], y: [number, number]}} Brush
 */

/**
 * How a page looks at a session: what is drawn, the branch beside, the brush.
 * @typedef {{view: Seen, beside: string | null, brush: Brush | null}} Looked
 */

/**
 * A session that was left and can go on; `when`: its last change, s since 1970; else what is `wrong`.
 * @typedef {{id: string, when: number | null, ended: boolean, captures: string[], steps: number,
 *   wrong: string | null}} Left
 */

/**
 * The answer of `GET /api/state`: a session, what is being done to it, and what can go on.
 * @typedef {{schema: string, revision: number, captures: CaptureInfo[], branches: Branch[], active: string[],
 *   branch: string | null, node: string | null, noise_floor: number | null, unit: string, peak: number,
 *   below_hz: number | null, params: Param[], together: Together[], rmse: number | null,
 *   rmse_heldout: number | null, added: string[],
 *   concluded: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   sets: boolean, searched: boolean,
 *   verdict: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   record: string | null, carried: Carried[], ladder: LadderStep[], candidates: Candidates, warnings: string[],
 *   limitations: Limitation[], disagreements: Disagreement[], titles: Record<string, string>, absent: Effect[],
 *   untold: string[][], proposed: Law[] | null,
 *   proposed_said: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[],
 *   curve: Curve | null, surface: Surface | null, limits: Record<string, number> | null,
 *   experiment: Experiment | null, needless: string[], shown_along: string | null, job: Job | null,
 *   recording: boolean, looked: Looked | null, unread: string[], left: Left[], notes: string[]}} State
 */

/**
 * What an answer may say besides the revision.
 * @typedef {{job?: string, path?: string, log?: string, share?: number, hidden?: string[], cancelled?: boolean,
 *   cut?: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[], tried?: Law,
 *   unfinished?: string}} More
 */

/**
 * What a request is answered that changes or asks something, and where the session is now.
 * @typedef {{job?: string, path?: string, log?: string, share?: number, hidden?: string[], cancelled?: boolean,
 *   cut?: (string | Quantity | Stretch | OfAxis | OfEffect | OfParam | OfColumn | Topic | Advice)[], tried?: Law,
 *   unfinished?: string, revision: number, node: string | null}} Answer
 */

/**
 * A model that linked plots show, and what could be missing from it where that was weighed.
 * @typedef {{label: string, rmse: number, candidates: Candidates | null}} ShownStep
 */

/**
 * What linked plots show: models held against so many captures of `all` samples, torques up to `peak`.
 *
 * `titles` are those of all effects; `below_hz` as of `Session`.
 * @typedef {{unit: string, peak: number, below_hz: number | null, coordinate: "rotary" | "linear",
 *   noise: number | null, titles: Record<string, string>, captures: number, all: number, steps: ShownStep[]}}
 *   Shown
 */

/**
 * A column in few letters: `deflated` is base64 of n 32-bit differences, all lowest bytes first.
 *
 * A difference has its sign in its lowest bit; of the steps that they sum up to, 0 is NaN and 1 is `low`.
 * @typedef {{low: number, step: number, deflated: string}} Packed
 */

/**
 * The same where `n` of the samples are carried along.
 * @typedef {{unit: string, peak: number, below_hz: number | null, coordinate: "rotary" | "linear",
 *   noise: number | null, titles: Record<string, string>, captures: number, all: number, steps: ShownStep[],
 *   n: number}} Head
 */

/**
 * What a page holds in itself: columns, of each step its residual and what each candidate explains.
 * @typedef {{unit: string, peak: number, below_hz: number | null, coordinate: "rotary" | "linear",
 *   noise: number | null, titles: Record<string, string>, captures: number, all: number, steps: ShownStep[],
 *   n: number, columns: Record<string, Packed>, residuals: Packed[], signatures: Record<string, Packed>[]}} Kept
 */

/**
 * A knob that can be simulated, and the effects that it can hide.
 * @typedef {{name: string, words: string, hideable: string[]}} Knob
 */

/** A serial port, and what is plugged in there. @typedef {{port: string, words: string}} FoundPort */

/**
 * The answer of `GET /api/sources`: what captures can be made of; names with words for them.
 * @typedef {{knobs: Knob[], effects: Record<string, string>, titles: Record<string, string>,
 *   motions: Record<string, Record<string, string>>, no_emulated_rig: string | null, ports: FoundPort[],
 *   folder: string}} Sources
 */

/**
 * How a recording goes; what is not required comes with the first figures.
 * @typedef {{what: string, log: string, every: number, done: number | null, ended: boolean, error: string | null,
 *   capture: string | null, elapsed_s?: number, total_s?: number, received?: number, missing?: number,
 *   rate_hz?: number, peak_torque?: number | null, torque_limit?: number, clipped?: Record<string, number>,
 *   temperature?: number | null}} Live
 */

/**
 * The line in front of columns of bytes: their names, their length; `live` of a recording.
 * @typedef {{names: string[], n: number, dtype: "f32", live?: Live}} ColumnsHead
 */

/**
 * A column of a file that is no capture yet; `outline` is lowest and highest of its pieces, 0 to 1.
 * @typedef {{name: string, rows: number, low: number | null, high: number | null, outline: [number, number][]}}
 *   FileColumn
 */

/**
 * What a column of a capture may be, until a person says so; a unit that nobody knows is null.
 * @typedef {{expression: string, unit: string | null}} Guess
 */

/**
 * What a rig has latched, in words: its cause, and how long ago; `code` is by which it is cleared.
 * @typedef {{code: number, told: string}} Fault
 */

/**
 * What more there may be to say: `columns` of a file that could not be taken for a capture, a `fault`.
 *
 * `guess` has the columns of a capture that the file's seem to be, `enough` the limit with which there would
 * be a motion.
 * @typedef {{columns?: FileColumn[], guess?: Record<string, Guess>, fault?: Fault, enough?: Enough}} Why
 */

/**
 * What is wrong with a request.
 * @typedef {{columns?: FileColumn[], guess?: Record<string, Guess>, fault?: Fault, enough?: Enough,
 *   error: string}} Refused
 */

/**
 * The answer of `GET /api/challenge`: how it goes with what a capture hides.
 *
 * `more`: whether there is another hint; `wrong` effects were added and are not there; of the `hidden` ones
 * so many are `found`, and `solved` says that nothing else is in the model. While a challenge, which is
 * `graded` and of a `level`, is `sealed`, what the program thinks is not shown; `given_up`: it was told
 * before it was found.
 * @typedef {{hints: string[], more: boolean, wrong: string[], found: number, hidden: number, solved: boolean,
 *   given_up: boolean, graded: boolean, level: string, sealed: boolean, score: number}} Challenge
 */

/**
 * The answer of `GET /api/finding`: the samples of a finding, first and last of each run, from 0.
 * @typedef {{runs: [number, number][]}} Found
 */

export {};
