// Questions about the structures on the screen and in the lesson. Part of the page's script.
'use strict';

const kNames = 4;  // to choose from

/** Asks to find or to name what is shown, or the questions of scenes that have labels. Counts and saves the answers.
 * Calls the handlers {state(), restore(state), show(n), light(index): alone in the hulls of the others, changed()}. */
class Quiz {
  #model; #handlers;
  #before = null;    // state of the page; null: no quiz
  #question = null;  // {kind, text, asked, right: indices, since}; null: answered
  #left = [];        // questions
  #pool = [];        // structures that were shown at the start
  #rows = [];        // [kind, asked, answered, is right, seconds]

  constructor(model, handlers) {
    this.#model = model;
    this.#handlers = handlers;
    for (const kind of ['find', 'name', 'lesson']) onClick(`quiz-${kind}`, () => this.#start(kind));
    onClick('quiz-next', () => this.#next());
    onClick('quiz-end', () => this.#end());
    onClick('quiz-save', () => download('quiz.csv', new Blob([Quiz.csv(this.#rows)], {type: 'text/csv'})));
    this.forget();
  }

  /** Ends without a picture: the scenes are others. */
  forget() {
    this.#before = this.#question = null;
    this.#left = [];
    this.#tell('');
    byId('quiz-names').replaceChildren();
    byId('quiz-lesson').hidden = this.#ofLesson().length === 0;
  }

  isAsking() { return this.#question !== null; }

  /** Takes a click on a structure, or on none. @returns {boolean} false without a question */
  takes(index) {
    if (!this.isAsking()) return false;
    if (index !== null && this.#question.kind !== 'name') this.#answer(index);
    return true;
  }

  /** The structures that are drawn, but for ghosts. */
  #shown() {
    const {drawn, structures} = this.#model;
    return [...structures.keys()].filter(index =>
      !['off', 'ghost'].includes(drawn[index][0]) && this.#model.children(index).length === 0);
  }

  #ofLesson() {
    return this.#model.info.scenes.flatMap(({question, labels}, scene) => {
      const right = labels.flatMap(label => this.#model.named(label)).flatMap(index => this.#model.subtree(index));
      return question === '' || right.length === 0 ? [] : [{kind: 'lesson', text: question, asked: labels.join(', '), right, scene}];
    });
  }

  #start(kind) {
    if (this.#before) {
      this.#handlers.restore(this.#before);
    } else {
      this.#rows = [];
      this.#before = this.#handlers.state();
      this.#pool = this.#shown();
    }
    this.#left = kind === 'lesson' ? this.#ofLesson() : Quiz.shuffled(this.#pool).map(index => {
      const asked = this.#model.structures[index].name;
      return {kind, text: kind === 'find' ? `Click: ${asked}` : 'What is this?', asked, right: [index]};
    });
    this.#next();
  }

  #next() {
    const question = this.#question = this.#left.shift() ?? null;
    byId('quiz-names').replaceChildren();
    if (question === null) return this.#tell('No more questions.');
    if (question.kind === 'lesson') this.#handlers.show(question.scene);
    else if (question.kind === 'find' && this.#rows.length > 0) this.#handlers.restore(this.#before);
    if (question.kind === 'name') this.#offer(question.right[0]);
    question.since = performance.now();
    this.#handlers.changed();
    return this.#tell(question.text);
  }

  /** Offers the name of a structure among those of its nearest relatives. */
  #offer(index) {
    this.#handlers.light(index);
    const near = [];
    for (const group of this.#model.groups(index))
      near.push(...Quiz.shuffled(this.#model.leaves(group)).filter(leaf => leaf !== index && !near.includes(leaf)));
    near.push(...Quiz.shuffled(this.#pool).filter(leaf => leaf !== index && !near.includes(leaf)));
    byId('quiz-names').replaceChildren(...Quiz.shuffled([index, ...near.slice(0, kNames - 1)]).map(each => {
      const button = element('button', {}, nameElement(this.#model.structures[each].name));
      button.addEventListener('click', () => { if (this.isAsking()) this.#answer(each); });
      return button;
    }));
  }

  #answer(index) {
    const {kind, asked, right, since} = this.#question;
    this.#question = null;
    const {name} = this.#model.structures[index];
    const isRight = right.includes(index);
    this.#rows.push([kind, asked, name, isRight ? 1 : 0, ((performance.now() - since) / 1000).toFixed(1)]);
    this.#tell(isRight ? `Right: ${name}.` : kind === 'name' ? `No, it is ${asked}.` : `No, that is ${name}.`);
    if (!isRight && kind !== 'name') this.#handlers.light(right[0]);
    this.#handlers.changed();
  }

  #end() {
    this.#handlers.restore(this.#before);
    this.forget();
  }

  #tell(text) {
    byId('quiz-task').replaceChildren(nameElement(text));
    const right = this.#rows.filter(row => row[3] === 1).length;
    byId('quiz-score').textContent = this.#rows.length === 0 ? '' : `${right} of ${this.#rows.length} right`;
    byId('quiz-next').disabled = byId('quiz-end').disabled = this.#before === null;
    byId('quiz-save').disabled = this.#rows.length === 0;
  }

  static csv(rows) {
    const field = value => `"${String(value).replaceAll('"', '""')}"`;
    return [['kind', 'asked', 'answered', 'right', 'seconds'], ...rows].map(row => `${row.map(field).join(',')}\r\n`).join('');
  }

  static shuffled(values) {
    return values.map(value => [Math.random(), value]).sort(([a], [b]) => a - b).map(([, value]) => value);
  }
}
