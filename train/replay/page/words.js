// @ts-check
/** One plain line for every word on the page: controls, layers, events, terms, sensors, behaviours, goals. */

/** By the id of a control, the name of a layer or of a kind of events, or the word itself. @type {Record<string, string>} */
export const WORDS = {
  play: "Run the time, or stop it (space).",
  step: "Run one control period, 0.2 s of the mission (right arrow).",
  speed: "Seconds of the mission in a second (+ and -).",
  time: "The time in the mission: drag it to look at another moment.",
  now: "The time in the mission.",
  head: "Go back to what happens now; the past stays as it was.",
  theme: "Switch between dark and light colours.",
  again: "The same mission from its beginning, with the same strategy, in a new recording.",
  jam: "The same mission from its beginning under another strategy, in a new recording.",
  mission: "Missions, families and tasks that can be played.",
  open: "Run the mission on the left, in a new recording.",
  strategy: "What chooses the options of all robots from the next decision on.",
  option: "An option that robots hold whatever the strategy chooses.",
  hold: "Let the chosen robot hold the option.",
  hold_all: "Let all robots hold the option.",
  what_if: "What happens to the chosen robot in the next five seconds under each option; nothing is changed.",
  tool: "What a click on the world does. Robots and items can always be dragged.",
  fail: "Let the chosen robot fail for ever; its body stays.",
  remove: "Take the chosen robot away.",
  loss: "Share of the messages about poses and pheromones that are lost.",
  loss_now: "Share of the messages that are lost.",
  goal: "Robots and charts have the colours of the options of one goal: choose which.",
  follow: "Keep the chosen robot in the middle of the picture (f).",
  whole: "Show the whole world again.",
  parting: "Go to the first moment at which the runs differ.",
  timeline: "When something happened; click to go there.",
  fields: "What robots have left behind and others smell: they mark where somebody has been.",
  reach: "How far the repelling gradient of each robot reaches: others keep out of it.",
  view: "How far beyond its body a robot looks for others under its option.",
  seen: "A half line from each robot to each other one that it sees.",
  paths: "Where robots were in the last 20 seconds; the thick one is that of the chosen robot.",
  contacts: "A red ring around robots that touch.",
  numbers: "The number of each robot.",
  zones: "Places where messages get lost, or where robots drive slowly.",
  walls: "Walls, which bodies cannot cross.",
  command: "The velocity that the robot was told to drive, as long as its way in a second.",
  added: "What the mechanism of its option has added to what the robot wanted.",
  target: "From the chosen robot to where it wants to go.",
  causes: "From the chosen robot to those because of whom it turns; thick: they count more.",
  found: "A robot has picked an item.",
  recycled: "A robot has brought an item to a recycling station.",
  dumped: "A robot has brought the leftovers of an item to a dump: the item is done.",
  put: "A robot has put down an item.",
  contact: "Two robots came closer than the first collision distance.",
  switch: "A robot holds another option than before.",
  replan: "A robot has another plan than before.",
  joined: "A robot has joined the team.",
  failed: "A robot has failed or left.",
  hand: "A person has changed something.",
  item: "Garbage that lies on the floor.",
  "leftovers of an item": "What is left of an item after recycling; it has to go to a dump.",
  "recycling station": "Where items are brought first.",
  "dump station": "Where leftovers are brought.",
  pheromones: "What robots have left behind; stronger where somebody has just been.",
  "failed robot": "A robot that does nothing any more; its body stays.",
};

/** What the options of a goal decide. @type {Record<string, string>} */
export const GOAL_WORDS = { AvoidCollision: "how they avoid others", ExplorationPatrol: "how they explore", Transport: "which station they go to" };

/** Of the three charts below a world. */
export const CHART_WORDS = [
  "A line for each robot, a colour for each option; grey: it has failed.",
  "The work that is done and the collisions, over time.",
  "Scores, estimates or probabilities, a colour for each option.",
];

/** Terms of an activation. @type {Record<string, string>} */
export const TERM_WORDS = {
  preconditions: "What the sensors say about whether the behaviour can run.",
  goals: "How much the behaviour would help a goal.",
  goal_inhibition: "How much it would hinder a goal; taken away.",
  predecessors: "Given by behaviours that make this one possible.",
  successors: "Given by behaviours that this one makes possible.",
  conflictors: "Taken away by behaviours whose conditions this one would spoil.",
  plan: "Added because the behaviour is the next step of the plan.",
};

/** Sensors, behaviours and goals of the cleaning robot. @type {Record<string, string>} */
const ROBOT_WORDS = {
  garbage_seen: "1 while the robot sees an item.",
  garbage_at: "1 while it is close enough to pick an item.",
  garbage_found: "1 from seeing an item until its leftovers are dumped.",
  carrying: "1 while it carries something.",
  recycled: "1 when what it carries has been recycled.",
  at_recycling: "1 at a recycling station.",
  at_dump: "1 at a dump.",
  dist_recycling: "Distance to the nearest recycling station [m].",
  dist_dump: "Distance to the nearest dump [m].",
  patrolled: "Never 1: patrolling has no end.",
  rep_bool: "1 while others are so near that the robot must avoid them.",
  rep_len: "Length of the vector away from the others [m].",
  too_near: "1 while the mechanism wants to avoid others by itself.",
  AvoidCollision: "Keep out of the way of other robots.",
  ExplorationPatrol: "Look for garbage where nobody has been for a while.",
  Patrol: "Look for garbage where nobody has been for a while.",
  Transport: "Choose a station, and wait before it where others are first.",
  MoveToGarbage: "Drive to the item that it sees.",
  PickGarbage: "Pick the item up.",
  MoveToRecycling: "Carry the item to a recycling station.",
  Recycle: "Recycle the item; its leftovers stay.",
  MoveToDump: "Carry the leftovers to a dump.",
  Dump: "Dump the leftovers: the item is done.",
  PatrolEnvironment: "The goal to look at the whole world again and again.",
  GarbageCleaned: "The goal that no garbage is left.",
};

/** Inputs of a policy, by the beginning of their names; the longest that fits counts. @type {Record<string, string>} */
const INPUT_WORDS = {
  garbage_: "The nearest item in sight: 1 if there is one, and the way to it by the range of sight.",
  carrying: "1 while it carries something.",
  recycled: "1 when what it carries has been recycled.",
  phase_: "1 in this phase: nothing in sight, an item in sight, on the way to recycling, on the way to the dump.",
  free_far: "1 while it carries nothing and is far from all stations.",
  free_near: "1 while it carries nothing near a station.",
  carrying_far: "1 while it carries something far from all stations.",
  carrying_near: "1 while it carries something near a station.",
  recycling_: "The way to the nearest recycling station, by half the diagonal of the world; _near: 1 at it.",
  dump_: "The way to the nearest dump, by half the diagonal of the world; _near: 1 at it.",
  target_: "The way to the station that its cargo has to go to, by half the diagonal of the world; 0 without cargo.",
  neighbour_: "The nearest robot that it has heard: the way to it, its heading, and how fast it comes closer.",
  crowd_: "Robots that it has heard within this distance, by six.",
  avoidance_length: "Length of the vector away from others.",
  avoiding: "1 while it avoids others.",
  speed: "Its speed, by the largest.",
  turn_rate: "How fast it turns, by the fastest.",
  time_left: "Share of the time limit that is left.",
  idle: "Time since it last picked, recycled or dumped something, by one minute.",
  holds_: "1 while it holds this option.",
  finds_none: "1 if it has heard of no find in the last two minutes.",
  finds_apart: "1 if the finds of the last two minutes lie far apart.",
  finds_together: "1 if the finds of the last two minutes lie in one place.",
  recent_finds_none: "1 if it has heard of no find in the last 24 s.",
  recent_finds_one: "1 if it has heard of one find in the last 24 s.",
  recent_finds_apart: "1 if the finds of the last 24 s lie far apart.",
  recent_finds_together: "1 if the finds of the last 24 s lie in one place.",
  identity: "Its number, by the size of its team.",
  collided_: "1 for what its collisions of the last minutes did: there were none, they did not stop it, they stopped it.",
  collisions: "Its collisions of the last minutes, by six.",
  stopped: "Share of the last minutes for which collisions stopped it.",
  load_: "Robots nearer than it to the nearest station, and to the next one, by six.",
  next_farther: "How much farther the next station is; 1 without any.",
  true_: "What no robot can know; the policy is told it.",
};

/** Return the line for an input of a policy. @param {string} name */
export function inputWord(name) {
  const [best] = Object.keys(INPUT_WORDS).filter((start) => name.startsWith(start)).sort((a, b) => b.length - a.length);
  return best ? INPUT_WORDS[best] : `Input ${name} of the policy.`;
}

/** Return the line for a sensor, a behaviour or a goal. @param {string} kind @param {string} name */
export const robotWord = (kind, name) => ROBOT_WORDS[name] ?? `${kind} ${name} of the robot's own file.`;

/** Return the line for an option: the first sentence about its configuration. @param {import("./recording.js").Head} head @param {string} goal @param {string} option */
export const optionWord = (head, goal, option) => head.option_words?.[goal]?.[head.options[goal].indexOf(option)] || `An option for ${goal}.`;

/** Give every control its line. @param {Document} page */
export function explainWords(page) {
  for (const one of page.querySelectorAll("button[id], select[id], input[id], output[id], canvas[id]"))
    if (WORDS[one.id] && !one.getAttribute("title")) one.setAttribute("title", WORDS[one.id]);
  for (const label of page.querySelectorAll("label[for]"))
    label.setAttribute("title", WORDS[label.getAttribute("for") ?? ""] ?? "");
  const groups = { anew: "Which mission runs.", deciding: "Who chooses the options of the robots.", hand: "What you do to the world; it is recorded.",
    layers: "What is drawn.", view: "What part of the world is drawn.", signs: "What colours and signs mean.", keys: "What the keys do." };
  for (const [id, words] of Object.entries(groups)) page.querySelector(`#${id} summary`)?.setAttribute("title", words);
}
