"""ADBench's LSTM, whose weights are diagonal."""
import numpy as np


def sigmoid(x):
    return 1.0 / (1.0 + np.exp(-x))


def layer(weight, bias, hidden, cell, x):
    """One step of a layer: writes its hidden state and its cell."""
    b = x.size
    for i in range(b):
        forget = sigmoid(x[i] * weight[i] + bias[i])
        ingate = sigmoid(hidden[i] * weight[b + i] + bias[b + i])
        outgate = sigmoid(x[i] * weight[2 * b + i] + bias[2 * b + i])
        change = np.tanh(hidden[i] * weight[3 * b + i] + bias[3 * b + i])
        cell[i] = cell[i] * forget + ingate * change
        hidden[i] = outgate * np.tanh(cell[i])


def objective(main_params, extra_params, state, sequence):
    """The loss of predicting each row of the sequence (c, b) from those before; main_params (2 l, 4 b) has a row of
    weights and one of biases for each layer, extra_params (3, b) the weights of the input and the output and the
    output's bias, state (2 l, b) the hidden state and the cell of each layer at the start."""
    c, b = sequence.shape
    state = state.copy()
    x = np.empty(b)
    total = 0.0
    for t in range(c - 1):
        for i in range(b):
            x[i] = sequence[t, i] * extra_params[0, i]
        for k in range(0, state.shape[0], 2):
            layer(main_params[k], main_params[k + 1], state[k], state[k + 1], x)
            x[:] = state[k]
        exponentials = 2.0
        for i in range(b):
            x[i] = x[i] * extra_params[1, i] + extra_params[2, i]
            exponentials += np.exp(x[i])
        normal = np.log(exponentials)
        for i in range(b):
            total += sequence[t + 1, i] * (x[i] - normal)
    return -total / (b * (c - 1))
