// @ts-check
/**
 * The messages from and to the server; the other end is `socket.rs` and `orders.rs` of the station.
 *
 * @typedef {number | 'clear' | null} Cell A value of a row; 'clear': nothing within the sonar's reach; null: not known.
 *
 * @typedef {object} ModeEntry
 * @property {number} id
 * @property {string} name
 * @property {string} about What it does, in a few words.
 * @property {Reference | null} reference
 * @property {number | null} idle The state in which its reference is not in force.
 * @property {boolean} heading It has a heading setpoint.
 * @property {boolean} movements Takes basic movements.
 * @property {number | null} route Takes a route of at most so many places.
 * @property {boolean} velocity Takes velocities, repeated.
 * @property {boolean} lane Follows a lane on command.
 * @property {string[]} rigs The rigs it can drive with.
 * @property {[string, number[]][]} parameters Title and numbers of each group, the most important first.
 * @property {[string, string, number[], number[]][]} laws Its equations: the signal that each gives, what it is, the parameters within its terms, and the states in which it holds; none: in all.
 * @property {string[]} plots Titles of the default plots.
 * @property {string[]} states
 * @property {[number, number, string][]} ways Between the states: from, to, when.
 *
 * @typedef {object} Reference The reference of a mode [m or rad/s].
 * @property {'distance' | 'wheel_speed' | 'speed' | 'goal'} kind
 * @property {number} min
 * @property {number} max
 * @property {number} offered The value to offer first.
 * @property {boolean} commanded A command sets it; otherwise the mode determines it.
 *
 * @typedef {{x_m: number, y_m: number, heading_rad: number}} Pose World frame, counter-clockwise heading.
 * @typedef {{x_m: number, y_m: number, correlation: number, heading_rad: number}} Spread Standard deviations of a pose, from its origin.
 * @typedef {{id: number, at: Pose, half_angle_rad: number, reach_m: number, on_servo: boolean}} SonarMount
 * @typedef {{corners_m: [number, number][], closed: boolean}} Obstacle
 * @typedef {{corners_m: [number, number][], waypoints: {t_s: number, at: Pose}[], repeat: 'once' | 'loop' | 'back_and_forth', start_s: number}} Mover Corners in its own frame; times of the waypoints from its start.
 *
 * @typedef {{x_m: number, y_m: number, heading_rad: number | null}} Place
 * @typedef {{repeat: boolean, relative: boolean, waypoints: Place[]}} Route From the robot's origin, or from where it starts.
 *
 * @typedef {object} Scene
 * @property {{scenario: string, world: string | null, rig: string | null, seed: number}} choice
 * @property {{name: string, title: string, group: string | null, mode: number, shows_mode: boolean}[]} experiments The scenarios to choose from; `shows_mode`: it commands something in its mode.
 * @property {string[]} worlds
 * @property {Record<string, string>} [world_titles] What each of them is; logs of earlier versions have none.
 * @property {string[]} rigs
 * @property {string} rig What the robot carries.
 * @property {[number, number][]} goals The experiment's goals, from the origin [m].
 * @property {Route[]} routes The experiment's routes.
 * @property {string} robot
 * @property {Pose} start Origin of the odometry in the world.
 * @property {Obstacle[]} obstacles
 * @property {{points_m: [number, number][], width_m: number}[]} [lines] Dark lines on the floor.
 * @property {{at_m: [number, number], lumen: number}[]} [lamps]
 * @property {Mover[]} [movers] What moves, whatever the robot does.
 * @property {{name: string, footprint_m: [number, number][]}[]} [others] The other robots in the world.
 * @property {[number, number][]} footprint_m
 * @property {number} base_m
 * @property {number} wheel_radius_m
 * @property {SonarMount[]} sonars
 * @property {string[]} [other_sonars] The names of those from number 3 on.
 * @property {boolean} [of_ghost] The robot itself is not simulated.
 *
 * @typedef {object} Parameter
 * @property {number} id
 * @property {string} name
 * @property {string} unit
 * @property {number} min
 * @property {number} max
 * @property {number} default
 * @property {'number' | 'switch' | 'choice'} type
 * @property {string[]} choices Names of the values 0, 1, ... of a switch or a choice.
 * @property {boolean} of_robot It belongs to the robot, not to modes.
 * @property {string} description
 * @property {number | null} value
 * @property {boolean} pending
 * @property {string | null} refused
 *
 * @typedef {object} Task The robot's goal, from its origin.
 * @property {[number, number] | null} goal
 * @property {boolean} lane
 * @property {Route | null} route
 * @property {[number, number, number] | null} from Where it stood when it was armed: x, y [m] and heading [rad].
 * @property {'reached' | 'unreachable' | 'gave_up' | null} end
 *
 * @typedef {{rows: {name: string, found: number, standard_error: number | null}[], parameters: [number, number][], before: [number, number][]}} Findings Of a calibration: what was found, and the parameters set, with their values before.
 *
 * @typedef {object} State
 * @property {number} t_s
 * @property {boolean} simulated
 * @property {number} speed
 * @property {number} achieved_speed
 * @property {string} [refused] The last order, if it was refused or dropped, and why.
 * @property {string[]} [alarms] Alarms that need action at once.
 * @property {{number: number} & ({phase: 'running', since_s: number} | {phase: 'done', findings: Findings} | {phase: 'failed', why: string})} [calibration]
 * @property {Experiment} [experiment] The scenario that commands the robot, or has done so in this run.
 * @property {boolean} [motors_cut] STOP or OFF cut the supply of the motors of a program that may ignore them.
 * @property {{name: string, link_usart: number | null, phase: 'running' | 'compiling' | 'rejected', watched: boolean, parts?: Part[], complaints?: {place: string | null, text: string, line: string | null}[], profile?: Profile, held?: HeldState}} [program] Of an emulated robot; what the compiler rejects of it; where its time goes, while that is counted.
 * @property {{name: string, duration_s: number}} [replay] A log is shown; t_s is where.
 * @property {{connected: boolean, telemetry_hz: number, down_load: number, up_load: number, baud: number, round_trip_ms: number | null,
 *   crc_errors_down: number, crc_errors_up: number, frames_lost: number, dropped: number, unacknowledged: number,
 *   clock_offset_ms?: number, clock_fast_ppm?: number}} link When the robot's clock began, in the session's time, and by how much it is fast.
 * @property {{mode: number, armed: boolean, fault: string | null, battery_v: number | null, true_battery_v: number | null,
 *   reference: [number, number], overruns: number, servo_rad: number, rig: string | null, task: Task, foreign: boolean, text?: boolean}} robot `text`: it speaks the original's.
 *
 * @typedef {{name: string, min: number | null, max: number | null, value: number | null, kept: boolean}} Limit Of a metric, in its own unit; `value`: null before the end, and where what it measures did not happen.
 * @typedef {{phase: 'running' | 'passed' | 'failed' | 'stopped', duration_s: number, limits: Limit[], failures?: string[], parameters?: [string, number][]}} Experiment `parameters`: those that are not the scenario's.
 *
 * @typedef {object} Profile Where the time of a program goes, in cycles of its clock.
 * @property {number} cycles
 * @property {number} asleep
 * @property {number} hertz
 * @property {{name: string, calls: number, own: number, total: number}[]} functions
 * @property {{vector: number, name: string, count: number, total: number, mean: number, longest: number, worst_latency: number}[]} interrupts
 *
 * @typedef {{source: 'truth' | 'loops' | 'others' | {usart: number}, names: string[], rows: [number, Cell[]][]}} ReadingGroup Time [s] and values of signals beside the telemetry; `usart`: the port that printed them.
 *
 * @typedef {{name: string, bytes: number, written_s: number, open: boolean, readable: boolean, duration_s: number, started: string | null, scenario: string | null, robot: string | null, seed: number | null}} Recording
 * @typedef {{name: string, duration_s: number, metrics: Record<string, number | null>, parameters: Record<string, number>, columns: string[], rows: Cell[][]}} RecordingContent
 *
 * @typedef {{t_s: number, level: 'info' | 'good' | 'warning' | 'fault', text: string}} LoggedEvent
 *
 * @typedef {{t_s: number, to_robot: boolean, hex: string}} LinkBytes Raw bytes that crossed the link together.
 *
 * @typedef {{ticket: number, model: import('./world_shapes.js').World | null, toml: string, problem: string | null, driven: boolean}} EditedWorld A world to edit: what its file holds, its text, what is wrong with it.
 *
 * @typedef {{name: string, kind: 'button' | 'switch' | 'potentiometer' | 'led' | 'buzzer' | 'infrared' | 'mpu6050' | 'vl53l0x' | 'qmc5883l' | 'hmc5883l' | 'ssd1306' | 'hd44780', percent: number, address?: number, keys?: string[]}} Part Something at a pin of an emulated robot, or at an address of its two-wire bus.
 * @typedef {{stands: boolean, t_us: number, back_us: number}} HeldState A program in the hands of the debugger, where in its time it is, and how far back.
 * @typedef {{name: string, text: string}} SketchFile
 * @typedef {{ticket: number, name: string, files: SketchFile[], examples: string[]}} ShownSketch The source of a program.
 * @typedef {{type: 'response' | 'event', event?: string, request_seq?: number, success?: boolean, message?: string, body?: any}} DebugMessage Of the Debug Adapter Protocol.
 * @typedef {{usart: number, text: string}} ConsoleText Output of a USART of an emulated chip.
 *
 * @typedef {{type: 'hello', version: string, columns: string[], modes: ModeEntry[], robots?: string[], robot: number}
 *   | {type: 'scene', run: number, scene: Scene | null}
 *   | {type: 'parameters', parameters: Parameter[]}
 *   | {type: 'state', run: number, orders: number, state: State}
 *   | {type: 'samples', run: number, heard: [number, number], rows: Cell[][]}
 *   | {type: 'readings', run: number, groups: ReadingGroup[]}
 *   | {type: 'events', events: LoggedEvent[]}
 *   | {type: 'bytes', bytes: LinkBytes[]}
 *   | {type: 'consoles', run: number, said: ConsoleText[]}
 *   | ({type: 'world'} & EditedWorld)
 *   | ({type: 'sketch'} & ShownSketch)
 *   | {type: 'debug', messages: DebugMessage[]}
 *   | {type: 'control', seat: Seat, page: number, holder: number | null, pages: number}
 *   | {type: 'error', text: string}} FromServer
 *
 * @typedef {'viewer' | 'free' | 'driver' | 'passenger'} Seat Who has control, as far as this page is concerned. Pages have numbers, in the order in which they came.
 *
 * @typedef {{type: 'stop' | 'take_control' | 'release_control' | 'restart_ghost' | 'arm' | 'disarm' | 'clear_fault' | 'reset_params' | 'save_params' | 'reset_pose' | 'calibrate' | 'play'}
 *   | {type: 'mode', mode: number}
 *   | {type: 'reference', value: number}
 *   | {type: 'wheel_reference', left: number, right: number}
 *   | {type: 'move_duty', movement: number, duty: number, held?: boolean}
 *   | {type: 'move_speed', movement: number, speed_rad_s: number, held?: boolean}
 *   | {type: 'velocity', forward_m_s: number, yaw_rad_s: number}
 *   | {type: 'goal', x_m: number, y_m: number}
 *   | {type: 'lane'}
 *   | {type: 'route', repeat: boolean, relative: boolean, waypoints: {x_m: number, y_m: number}[]}
 *   | {type: 'waypoint', x_m: number, y_m: number}
 *   | {type: 'rig', rig: string}
 *   | {type: 'set_param', id: number, value: number}
 *   | {type: 'program', name: string, data?: string, files?: SketchFile[], debug?: boolean, robot?: string}
 *   | {type: 'sketch', ticket: number, example?: string}
 *   | {type: 'debug', request: object}
 *   | {type: 'profile', on: boolean}
 *   | {type: 'world', ticket: number, act: 'show' | 'check' | 'drive', text: string}
 *   | {type: 'type', usart: number, text: string, ending: string}
 *   | {type: 'speed', factor: number}
 *   | {type: 'seek', t_s: number}
 *   | {type: 'step', frames: number}
 *   | {type: 'reset', scenario: string, world: string | null, rig: string | null, seed: number}} Order
 */
export {};
