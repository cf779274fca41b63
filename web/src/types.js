/**
 * What the server tells: the document of `GET /api/state`. Torques in N m (forces in N on a linear axis).
 *
 * @typedef {{id: string, name: string, samples: number, rate_hz: number, axis: string,
 *   findings: string[], hides: boolean}} CaptureInfo
 * @typedef {{node: string, added: string | null, dropped?: string | null, rmse: number,
 *   rmse_heldout: number, captures: string[]}} Step
 * @typedef {{id: string, name: string, steps: Step[], at: number}} Branch
 * @typedef {{name: string, value: number, ci95: [number, number] | null, unit: string, role: string,
 *   fitted: number, dragged: boolean, lower: number | null, upper: number | null, odd: string | null,
 *   meaning?: string}} Param
 * @typedef {{effect: string, place: string, law: string, source: string, shows: string,
 *   confused: string[], name: string, about: string, causes: string[], remedies: string[]}} Effect
 * @typedef {Effect & {error_fall: number, p_value: number, unphysical: string[],
 *   equivalent: string[], beyond_chance: boolean, note: string}} Candidate
 * @typedef {{axis: string, share: number, hint: string}} Unexplained
 * @typedef {{id: string, what: string, done: number | null, recording?: boolean}} Job
 * @typedef {{schema: string, captures: CaptureInfo[], active: string[], branches: Branch[], branch: string,
 *   node: string | null, noise_floor: number | null, unit: string, params: Param[], rmse: number,
 *   rmse_heldout: number, verdict_text: string,
 *   candidates: {ready: boolean, rows: Candidate[], unexplained: Unexplained | null},
 *   job: Job | null, recording: boolean, revision: number, warnings?: string[], limitations: string[], absent: Effect[]}} State
 */

/**
 * A column of a file that is no capture yet; `outline` has the lowest and highest of its pieces, from 0 to 1.
 * @typedef {{name: string, rows: number, low: number | null, high: number | null,
 *   outline: [number, number][]}} FileColumn
 */

/**
 * A rectangle in pixels of a plot's raster, all edges inside it.
 * @typedef {{left: number, right: number, top: number, bottom: number}} Rect
 */

/**
 * Columns of samples, all captures one after the other.
 * @typedef {Record<string, Float32Array>} Columns
 */

export {};
