// All tests of the page's modules, in one script.

import "./attitude_test.js";
import "./motion_test.js";
import "./pair_test.js";
import "./player_test.js";
import "./stage_test.js";
import { results } from "./check.js";

globalThis.results = results;
