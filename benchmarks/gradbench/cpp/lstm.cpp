// ADBench's LSTM, whose weights are diagonal, and its gradient; what each cell computes is recorded.
#include <algorithm>
#include <cmath>
#include <vector>

struct Cell {
  double x, hidden, cell, forget, ingate, outgate, change, bent;
};

static double sigmoid(double x) { return 1.0 / (1.0 + std::exp(-x)); }

static double loss(int layers, int c, int b, const double* main, const double* extra, const double* start,
                   const double* sequence, Cell* tape, double* outputs) {
  std::vector<double> state(start, start + 2 * layers * b), x(b);
  double total = 0.0;
  for (int t = 0; t < c - 1; t++) {
    for (int i = 0; i < b; i++) x[i] = sequence[t * b + i] * extra[i];
    for (int k = 0; k < layers; k++) {
      const double *w = main + 8 * k * b, *bias = w + 4 * b;
      double *hidden = &state[2 * k * b], *cell = hidden + b;
      for (int i = 0; i < b; i++) {
        Cell now;
        now.x = x[i], now.hidden = hidden[i], now.cell = cell[i];
        now.forget = sigmoid(x[i] * w[i] + bias[i]);
        now.ingate = sigmoid(hidden[i] * w[b + i] + bias[b + i]);
        now.outgate = sigmoid(x[i] * w[2 * b + i] + bias[2 * b + i]);
        now.change = std::tanh(hidden[i] * w[3 * b + i] + bias[3 * b + i]);
        cell[i] = cell[i] * now.forget + now.ingate * now.change;
        now.bent = std::tanh(cell[i]);
        x[i] = hidden[i] = now.outgate * now.bent;
        if (tape) *tape++ = now;
      }
    }
    double sum = 2.0;
    for (int i = 0; i < b; i++) {
      if (outputs) outputs[t * b + i] = x[i];
      x[i] = x[i] * extra[b + i] + extra[2 * b + i];
      sum += std::exp(x[i]);
    }
    const double normal = std::log(sum);
    for (int i = 0; i < b; i++) total += sequence[(t + 1) * b + i] * (x[i] - normal);
  }
  return -total / (b * (c - 1));
}

extern "C" double lstm_objective(int layers, int c, int b, const double* main, const double* extra,
                                 const double* state, const double* sequence) {
  return loss(layers, c, b, main, extra, state, sequence, nullptr, nullptr);
}

extern "C" void lstm_jacobian(int layers, int c, int b, const double* main, const double* extra, const double* state,
                              const double* sequence, double* out) {
  std::vector<Cell> tape((c - 1) * layers * b);
  std::vector<double> outputs((c - 1) * b), states(2 * layers * b), x_bar(b), y(b);
  loss(layers, c, b, main, extra, state, sequence, tape.data(), outputs.data());
  double *main_bar = out, *extra_bar = out + 8 * layers * b;
  std::fill(out, extra_bar + 3 * b, 0.0);
  const double seed = -1.0 / (b * (c - 1));
  for (int t = c - 2; t >= 0; t--) {
    const double *wanted = sequence + (t + 1) * b, *last = &outputs[t * b];
    double sum = 2.0, all = 0.0;
    for (int i = 0; i < b; i++) {
      y[i] = std::exp(last[i] * extra[b + i] + extra[2 * b + i]);
      sum += y[i], all += wanted[i];
    }
    for (int i = 0; i < b; i++) {
      const double y_bar = seed * (wanted[i] - all * y[i] / sum);
      extra_bar[b + i] += last[i] * y_bar;
      extra_bar[2 * b + i] += y_bar;
      x_bar[i] = extra[b + i] * y_bar;
    }
    for (int k = layers - 1; k >= 0; k--) {
      const double* w = main + 8 * k * b;
      double *w_bar = main_bar + 8 * k * b, *bias_bar = w_bar + 4 * b;
      double *hidden_bar = &states[2 * k * b], *cell_bar = hidden_bar + b;
      const Cell* cells = &tape[(t * layers + k) * b];
      for (int i = 0; i < b; i++) {
        const Cell& now = cells[i];
        const double h_bar = hidden_bar[i] + x_bar[i];
        const double c_bar = cell_bar[i] + h_bar * now.outgate * (1.0 - now.bent * now.bent);
        const double o = h_bar * now.bent * now.outgate * (1.0 - now.outgate);
        const double f = c_bar * now.cell * now.forget * (1.0 - now.forget);
        const double in = c_bar * now.change * now.ingate * (1.0 - now.ingate);
        const double g = c_bar * now.ingate * (1.0 - now.change * now.change);
        w_bar[i] += f * now.x, bias_bar[i] += f;
        w_bar[b + i] += in * now.hidden, bias_bar[b + i] += in;
        w_bar[2 * b + i] += o * now.x, bias_bar[2 * b + i] += o;
        w_bar[3 * b + i] += g * now.hidden, bias_bar[3 * b + i] += g;
        cell_bar[i] = c_bar * now.forget;
        hidden_bar[i] = in * w[b + i] + g * w[3 * b + i];
        x_bar[i] = f * w[i] + o * w[2 * b + i];
      }
    }
    for (int i = 0; i < b; i++) extra_bar[i] += sequence[t * b + i] * x_bar[i];
  }
}
