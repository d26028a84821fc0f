// Every kind of value, function and scope that a debugger shows.
struct Point {
  int x;
  float y;
};
enum Mode { IDLE, DRIVE, TURN };
union Pair {
  uint16_t whole;
  uint8_t bytes[2];
};
struct Flags {
  uint8_t low : 3, high : 5;
};
namespace lab {
int shared = 7;
}

struct Base {
  bool made = true;
};
class Filter : public Base {
 public:
  Filter(float share) : share(share) {}
  float update(float value) {
    float before = state;
    state += share * (value - before);
    count++;
    return state;
  }

 private:
  float share, state = 0;
  unsigned long count = 0;
};

volatile unsigned long ticks;
Point path[3] = {{1, 0.5}, {2, 1.5}, {3, 2.5}};
Mode mode = IDLE;
Pair pair;
Flags flags;
Filter filter(0.25);

template <typename T>
T larger(T a, T b) {
  T best = a;
  if (b > a) best = b;
  return best;
}

int depth(int level) {
  int inner = level * 2;
  if (level > 0) inner += depth(level - 1);
  return inner;
}

long sum(const int *values, uint8_t count) {
  long total = 0;
  for (uint8_t i = 0; i < count; i++) {
    int value = values[i];
    total += value;
  }
  return total;
}

void move(Point &point, const Point *to) {
  int step = to->x - point.x;
  point.x += step / 2;
  point.y *= 1.25f;
}

ISR(TIMER3_COMPA_vect) {
  unsigned long now = ticks;
  ticks = now + 1;
}

void setup() {
  Serial.begin(115200);
  TCCR3B = _BV(WGM32) | _BV(CS31);
  OCR3A = 1999;
  TIMSK3 = _BV(OCIE3A);
}

void loop() {
  static uint8_t round_ = 0;
  int values[5] = {round_, 2, -3, 40, 500};
  bool odd = round_ & 1;
  char letter = 'a' + round_ % 26;
  long total = sum(values, 5);
  float smooth = filter.update(total);
  move(path[round_ % 3], &path[2]);
  mode = odd ? DRIVE : TURN;
  pair.whole += 257;
  flags.low = round_;
  int reached = depth(round_ % 4);
  int best = larger<int>(reached, values[0]) + lab::shared;
  Serial.print(letter);
  Serial.println(smooth + best);
  delay(20);
  round_++;
}
