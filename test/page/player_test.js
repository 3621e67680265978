// Time: the player, the speeds, the words for numbers.

import { Player, speedsFor } from "../../scripts/reporting/page/player.js";
import { inDegrees, inFull, inShort } from "../../scripts/reporting/page/text.js";
import { equal, near, test } from "./check.js";

test("speeds suit every duration", () => {
  for (let power = -9; power <= 9; power += 1) {
    for (const digit of [1, 2.6, 7.1577, 9.99]) {
      const duration = digit * 10 ** power;
      const { speeds, initial } = speedsFor(duration);
      equal(speeds.includes(initial), true, "whether the first speed is there");
      equal(duration / initial >= 5 && duration / initial <= 30, true, `pleasant for ${duration}`);
    }
  }
  equal(speedsFor(7).initial, 1, "speed");
});

test("playing goes on with the clock, ends at the end and begins again", () => {
  const said = [];
  const player = new Player(0, 2, () => said.push(player.playing));
  player.speed = 0.5;
  player.play();
  player.tick(1000);
  player.tick(2000);
  near(player.time, 0.5, 1e-15, "time");
  player.tick(99000);
  equal([player.time, player.playing, said], [2, false, [true, false]]);
  player.play();
  equal([player.time, player.playing], [0, true]);
  player.pause();
  player.tick(1e6);
  equal(player.time, 0, "time");
  equal([-1, 1.5, 9].map((time) => { player.seek(time); return player.time; }), [0, 1.5, 2], "times gone to");
});

test("an endless motion begins again, and slows down where frames are late", () => {
  const player = new Player(0, 1, () => {}, { isEndless: true });
  player.play();
  player.tick(0);
  player.tick(5000);
  near(player.time, 0.1, 1e-15, "time after a late frame");
  player.time = 0.95;
  player.tick(5100);
  equal([player.time, player.playing], [0, true]);
});

test("numbers are those of the table, or short", () => {
  equal(inFull(0.19634954084936207, true), "0.19634954084936207");
  equal(inFull(-1e-7, true), "\u22121e\u22127");
  equal(inFull(1 / 3, false), "0.3333333");
  equal(inDegrees(-Math.PI), "\u2212180.000°");
  equal(inDegrees(-1e-17, 1), "0.0°");
  equal(inShort(5.42699), "5.427");
});
