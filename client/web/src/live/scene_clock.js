/** The clock of a scene, as all who look at it see it; the wall clock's until the stream tells another. Fires `change`. */
export class SceneClock extends EventTarget {
  animated = false;
  steps_per_second = 10;
  /** After which it begins again at 0; 0: never. */
  loop_steps = 0;
  playing = true;
  /** The step, and the part of one, at an instant of `performance.now()`. */
  #step = 0;
  #at = 0;

  /** By the wall clock: so everybody sees the same without asking. @param {{animated: boolean, steps_per_second: number, loop_steps: number}} texture */
  follow_wall({animated, steps_per_second, loop_steps}) {
    Object.assign(this, {animated, steps_per_second, loop_steps, playing: true});
    this.#at = performance.now();
    this.#step = (Date.now() / 1000) * steps_per_second;
    this.dispatchEvent(new Event('change'));
  }

  /** As the stream tells it. @param {any} clock_now A ClockNow of proto/stream.proto. */
  follow({stepsPerSecond, loopSteps, playing, step, stepPart}) {
    Object.assign(this, {steps_per_second: stepsPerSecond || this.steps_per_second, loop_steps: Number(loopSteps), playing});
    this.#at = performance.now();
    this.#step = Number(step) + stepPart;
    this.dispatchEvent(new Event('change'));
  }

  /** The step in so many milliseconds. @param {number} [ahead] */
  step_in(ahead = 0) {
    const passed = this.playing ? ((performance.now() + ahead - this.#at) / 1000) * this.steps_per_second : 0;
    const step = Math.floor(this.#step + passed);
    return this.loop_steps > 0 ? ((step % this.loop_steps) + this.loop_steps) % this.loop_steps : step;
  }

  /** Milliseconds until the step after this one begins. */
  until_next() {
    const passed = ((performance.now() - this.#at) / 1000) * this.steps_per_second;
    const part = this.#step + passed;
    return ((Math.floor(part) + 1 - part) / this.steps_per_second) * 1000;
  }
}
